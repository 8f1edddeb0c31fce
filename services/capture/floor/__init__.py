"""Which plane the floor is, measured in every frame."""
