"""Interface to the active window, and ``open_window``, which connects to this desktop."""

from collections.abc import Mapping
from typing import Protocol

from neurotouch_hid.errors import DesktopError


class ActiveWindow(Protocol):
    """A connection to the desktop.

    Attributes:
        desktop: name of the desktop, for people.
    """

    desktop: str

    def names(self) -> tuple[str, ...]:
        """Returns the names of the active window's application; empty if no window is active.

        Raises:
            DesktopError: the desktop does not answer any more.
        """

    def close(self) -> None:
        """Ends the connection."""


def open_window(environment: Mapping[str, str]) -> ActiveWindow:
    """Returns a connection to the desktop that the environment names.

    Wayland has no common interface for this: sway and Hyprland have their own, GNOME and KDE have
    none. There, only the windows of X11 programs are known.

    Raises:
        DesktopError: there is no desktop, or it has no such interface.
    """
    from neurotouch_hid.desktop.compositor import Hyprland, Sway  # noqa: PLC0415
    from neurotouch_hid.desktop.x11 import XServer  # noqa: PLC0415

    if environment.get("SWAYSOCK"):
        return Sway(environment["SWAYSOCK"])
    if environment.get("HYPRLAND_INSTANCE_SIGNATURE"):
        return Hyprland(
            environment.get("XDG_RUNTIME_DIR", ""), environment["HYPRLAND_INSTANCE_SIGNATURE"]
        )
    if environment.get("DISPLAY"):
        if environment.get("WAYLAND_DISPLAY"):
            return XServer(environment["DISPLAY"], "X11 under Wayland, X11 programs only")
        return XServer(environment["DISPLAY"], "X11")
    if environment.get("WAYLAND_DISPLAY"):
        desktop = environment.get("XDG_CURRENT_DESKTOP") or "This desktop"
        raise DesktopError(
            f"The desktop {desktop} does not tell programs under Wayland which window is active.",
            hint="Switch by hand: neurotouch profile use NAME, or a gesture with next_profile.",
        )
    raise DesktopError("No desktop is running here.")
