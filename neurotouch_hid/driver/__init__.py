"""The running driver: source, pipeline and pad, and everything around them."""
