"""Compiled loops of the elastic method."""
