"""negative: where the floor ends, by each of the paper's methods and by all of them combined."""
