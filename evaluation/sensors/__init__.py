"""Depth sensors beside the simulator's Kinect: their cameras, and how they spoil an exact image."""
