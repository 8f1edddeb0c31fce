"""`cliffscan doctor`: what keeps a robot from working, each finding with its remedy."""
