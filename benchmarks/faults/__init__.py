"""Faults while the robot drives, and what becomes of it."""
