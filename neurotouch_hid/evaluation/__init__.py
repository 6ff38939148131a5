"""Measures the pipeline: its accuracy, its speed, and how well people do with it."""
