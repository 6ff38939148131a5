"""Which marker an event belongs to."""
