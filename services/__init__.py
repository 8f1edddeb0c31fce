"""The services: one folder, one process, one idea each; they never import one another."""
