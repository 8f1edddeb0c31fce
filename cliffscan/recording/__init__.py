"""Recordings: a robot's samples and its ROS topics in one MCAP file, made, mended, played and checked."""
