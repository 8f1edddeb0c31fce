"""What the messages of ROS say of a depth camera, whether they come live or from a recording."""
