"""Services, simulations and drivers that are started for a measurement."""
