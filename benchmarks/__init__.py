"""What is measured rather than asserted; each prints its figures."""
