"""What the fingers do together, and where they are seen to be."""
