"""The real services on two hosts that a poor link joins."""
