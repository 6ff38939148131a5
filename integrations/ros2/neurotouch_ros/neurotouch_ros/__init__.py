"""Publishes gestures and the pad of the gel as ROS 2 topics."""
