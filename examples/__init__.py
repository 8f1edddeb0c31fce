"""Programs that a third party would write: they know the wire format and nothing else of the project."""
