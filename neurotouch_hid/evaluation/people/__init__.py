"""Measures how well a person points with the gel."""
