"""What goes wrong with recordings."""


class RecordingError(Exception):
    """A recording cannot be made or used; the text is one line that says why."""
