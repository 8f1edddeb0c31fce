"""A Kobuki base without the base: its firmware, its wheels, its cable, and everything that can go wrong with them."""
