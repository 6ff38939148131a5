"""Interface to the active window, and ``open_window``, which connects to this desktop."""

from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

from neurotouch_hid.errors import DesktopError

_SETUP = "Install what makes it tell: neurotouch setup --windows"


class ActiveWindow(Protocol):
    """A connection to the desktop.

    Attributes:
        desktop: name of the desktop, for people.
        fd: becomes readable when another window may be active; None: ``names`` has to be called
            again and again.
    """

    desktop: str
    fd: int | None

    def names(self) -> tuple[str, ...]:
        """Returns the names of the active window's application; empty if no window is active.

        Raises:
            DesktopError: the desktop does not answer any more.
        """

    def close(self) -> None:
        """Ends the connection."""


def open_window(environment: Mapping[str, str]) -> ActiveWindow:
    """Returns a connection to the desktop that the environment names.

    Wayland has no common interface for this. Some compositors have one of their own. KDE and GNOME
    have none, but take a script. Where nothing else is known, the windows of X11 programs are.

    Raises:
        DesktopError: there is no desktop, or it has no such interface.
    """
    from neurotouch_hid.desktop.compositor import Hyprland, Sway  # noqa: PLC0415
    from neurotouch_hid.desktop.niri import Niri  # noqa: PLC0415
    from neurotouch_hid.desktop.x11 import XServer  # noqa: PLC0415

    if environment.get("SWAYSOCK"):
        return Sway(environment["SWAYSOCK"])
    if environment.get("HYPRLAND_INSTANCE_SIGNATURE"):
        return Hyprland(
            environment.get("XDG_RUNTIME_DIR", ""), environment["HYPRLAND_INSTANCE_SIGNATURE"]
        )
    if environment.get("NIRI_SOCKET"):
        return Niri(environment["NIRI_SOCKET"])
    if environment.get("WAYLAND_DISPLAY"):
        return _open_under_wayland(environment)
    if environment.get("DISPLAY"):
        return XServer(environment["DISPLAY"], "X11")
    raise DesktopError("No desktop is running here.")


def _open_under_wayland(environment: Mapping[str, str]) -> ActiveWindow:
    from neurotouch_hid.desktop.session_bus import (  # noqa: PLC0415
        GnomeShell,
        KWin,
        find_gnome_extension,
        find_kwin_script,
    )
    from neurotouch_hid.desktop.toplevels import Toplevels  # noqa: PLC0415
    from neurotouch_hid.desktop.x11 import XServer  # noqa: PLC0415

    desktops = environment.get("XDG_CURRENT_DESKTOP", "").split(":")
    script = find_kwin_script(environment)
    if "KDE" in desktops and script.exists():
        return KWin(script, Path(environment.get("XDG_RUNTIME_DIR", "/tmp")))  # noqa: S108
    if "GNOME" in desktops and find_gnome_extension(environment).exists():
        return GnomeShell()
    takes_script = "KDE" in desktops or "GNOME" in desktops
    if not takes_script:
        try:
            return Toplevels(environment)
        except DesktopError:
            pass  # then only the windows of X11 programs are known
    if environment.get("DISPLAY"):
        return XServer(
            environment["DISPLAY"],
            "X11 under Wayland, X11 programs only"
            + ("; 'neurotouch setup --windows' adds the others" if takes_script else ""),
        )
    desktop = environment.get("XDG_CURRENT_DESKTOP") or "This desktop"
    raise DesktopError(
        f"The desktop {desktop} does not tell programs under Wayland which window is active.",
        hint=_SETUP
        if takes_script
        else "Switch by hand: neurotouch profile use NAME, or a gesture with next_profile.",
    )
