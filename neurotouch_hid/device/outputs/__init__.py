"""Virtual devices: the pipeline writes them, and every program can read them."""
