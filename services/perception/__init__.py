"""perception: negative, positive and fuse in one process, for one robot, for several or for all."""
