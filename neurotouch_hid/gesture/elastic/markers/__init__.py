"""What the markers tell before any finger is fitted."""
