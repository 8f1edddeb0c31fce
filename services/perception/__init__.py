"""perception: negative, positive and fuse in one process."""
