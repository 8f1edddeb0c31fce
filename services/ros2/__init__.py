"""ros2: the robot as a ROS 2 node over rmw_zenoh, without a bridge and without ROS."""
