"""Meets a camera for the first time: asks for movements, measures the rig, keeps one file."""
