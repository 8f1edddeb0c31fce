"""What benchmarks and the demo share: scenes and worlds with their truth, scores, tables and pictures."""
