"""What shows the system at work: the paper's experiments, as the demo runs them."""
