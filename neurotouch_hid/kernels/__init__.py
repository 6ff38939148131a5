"""Compiled loops that several stages call."""
