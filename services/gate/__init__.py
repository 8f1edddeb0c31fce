"""The safety gate for a base of any make: commands and odometry in, safe velocities out."""
