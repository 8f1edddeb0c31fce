"""What every service shares: geometry, messages, topics, configuration, the bus and the service runner."""
