"""kobuki: the mobile base's serial protocol, odometry and safety."""
