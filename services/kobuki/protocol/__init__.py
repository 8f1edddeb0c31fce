"""The Kobuki's serial protocol: frames, packets, and what they mean."""
