"""Measures the speed of each stage and of the whole pipeline on this machine."""
