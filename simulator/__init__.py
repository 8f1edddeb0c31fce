"""A MuJoCo world seen by a simulated Kinect, and the exact truth about where its floor ends."""
