"""What is truly there, beam by beam and on a map."""
