"""fuse: the positive and the negative scan of one frame, and any extra inputs, as one scan."""
