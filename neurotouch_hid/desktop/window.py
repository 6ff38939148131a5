"""The active window, and the way to ask this desktop for it."""

from collections.abc import Mapping
from typing import Protocol

from neurotouch_hid.errors import DesktopError


class ActiveWindow(Protocol):
    """A connection to the desktop.

    Attributes:
        desktop: what is asked, for people.
    """

    desktop: str

    def names(self) -> tuple[str, ...]:
        """Returns what the active window's application calls itself; empty if no window is active.

        Raises:
            DesktopError: the desktop does not answer any more.
        """

    def close(self) -> None:
        """Ends the connection."""


def open_window(environment: Mapping[str, str]) -> ActiveWindow:
    """Returns a connection to the desktop that the environment names.

    Under Wayland there is no common way to ask: sway and Hyprland have one of their own, GNOME and
    KDE have none. Where X11 programs run beside Wayland's, theirs are the only windows seen.

    Raises:
        DesktopError: there is no desktop, or it does not tell.
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
            f"The desktop {desktop} tells no program under Wayland which window is active.",
            hint="Switch by hand: neurotouch profile use NAME, or a gesture with next_profile.",
        )
    raise DesktopError("No desktop is running here.")
