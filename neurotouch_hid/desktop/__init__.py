"""Watches which application is in front, where the desktop tells, for a profile of its own."""

from neurotouch_hid.desktop.follower import Follower
from neurotouch_hid.desktop.window import ActiveWindow, open_window

__all__ = ["ActiveWindow", "Follower", "open_window"]
