"""Random scenes of exact geometry, and the cameras that see them."""
