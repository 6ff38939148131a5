"""Which point is which: pairs of two sets, and how far they have moved."""
