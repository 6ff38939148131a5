"""Virtual devices: what the pipeline writes and every program reads."""
