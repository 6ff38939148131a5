"""Compiled loops of the camera's driver."""
