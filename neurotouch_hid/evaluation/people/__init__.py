"""How well a person points with the gel."""
