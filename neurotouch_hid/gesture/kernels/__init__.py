"""Compiled loops of all methods."""
