"""Measures the pipeline: its accuracy, its speed, and people's performance with it."""
