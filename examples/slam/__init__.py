"""SLAM plug-ins: scans and odometry in, a map and a pose out, over Zenoh."""
