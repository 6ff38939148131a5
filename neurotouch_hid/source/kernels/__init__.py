"""Compiled loops that several sources use."""
