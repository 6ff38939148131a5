"""Reads small files that a person or a stranger wrote, with limits."""
