"""The keys of a robot's processes: made, renewed and checked."""
