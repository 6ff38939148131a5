"""Compiled loops of the speed measurement."""
