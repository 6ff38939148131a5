"""Gives each application a profile of its own, where the desktop says which one is active."""

from neurotouch_hid.desktop.follower import Follower
from neurotouch_hid.desktop.window import ActiveWindow, open_window

__all__ = ["ActiveWindow", "Follower", "open_window"]
