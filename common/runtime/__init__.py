"""What every service runs on: the bus, configuration, metrics, a life cycle."""
