"""capture: depth frames from a Kinect, a recording or the simulator, each with its camera and floor plane."""
