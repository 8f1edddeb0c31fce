"""Robots that want to go everywhere, in worlds full of edges, with the gate between them and their wheels."""
