"""What is known about the markers."""
