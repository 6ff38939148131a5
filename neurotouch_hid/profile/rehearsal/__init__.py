"""Gestures written as text, and what a profile does with them."""
