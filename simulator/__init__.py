"""A robot in a MuJoCo world: its body, its Kobuki and its Kinect, and the exact truth about where the floor ends."""
