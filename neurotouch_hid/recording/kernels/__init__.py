"""Compiled loops of the recordings."""
