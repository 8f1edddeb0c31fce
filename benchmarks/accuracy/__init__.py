"""How well each method finds where the floor ends: random scenes of exact truth, every method side by side."""
