"""Compiled loops of the simulator: gel, optics, sensor."""
