"""Where depth frames come from: a file for each kind of camera."""
