"""What the neighbours of a marker say about where it is."""
