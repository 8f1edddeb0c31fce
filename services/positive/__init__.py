"""positive: what stands on the floor, by the projection method."""
