"""Gives each application a profile of its own, where the desktop says which one is active."""

from neurotouch_hid.desktop.follower import Follower
from neurotouch_hid.desktop.session_bus import (
    GNOME_UUID,
    find_data_folder,
    find_gnome_extension,
    find_kwin_script,
)
from neurotouch_hid.desktop.window import open_window

__all__ = [
    "GNOME_UUID",
    "Follower",
    "find_data_folder",
    "find_gnome_extension",
    "find_kwin_script",
    "open_window",
]
