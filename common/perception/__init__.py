"""From a depth image to scans: algorithms on arrays."""
