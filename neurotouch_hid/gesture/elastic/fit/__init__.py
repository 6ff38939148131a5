"""The least squares that finds the fingers in a field."""
