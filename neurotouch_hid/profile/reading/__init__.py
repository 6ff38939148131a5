"""From a file's name to a checked profile."""
