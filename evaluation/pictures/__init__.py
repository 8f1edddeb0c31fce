"""The pictures, each panel a function of axes."""
