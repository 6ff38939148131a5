"""Frames of an event camera whose LED ring goes off for a moment at regular times."""
