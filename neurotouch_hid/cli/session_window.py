"""Tells the service which profile the application in front has, for ``neurotouch session``."""

import os
import subprocess
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final

from neurotouch_hid.closing import Closing
from neurotouch_hid.files.stamps import Stamp, read_stamps

if TYPE_CHECKING:
    from neurotouch_hid.desktop import Follower
    from neurotouch_hid.desktop.window import ActiveWindow

TELL_S: Final = 2.0
"""Interval of repeating what was told; the service forgets it after three of them."""

_DESKTOP: Final = (
    *("WAYLAND_DISPLAY", "DISPLAY", "XAUTHORITY", "XDG_CURRENT_DESKTOP"),
    *("SWAYSOCK", "HYPRLAND_INSTANCE_SIGNATURE", "NIRI_SOCKET"),
)
"""The variables that name a desktop, the first two of them for every kind."""

_PATIENCE_S: Final = 5.0


class WindowTeller(Closing):
    """Follows the windows of this session for the service of one player.

    The applications are those of the person's ``driver.yaml``, or of the machine's where the person
    has none. Without any, nothing is asked of the desktop.

    Args:
        player: number of the player.
        announce: shows the person a sentence.
        open_window: connects to the desktop.
    """

    def __init__(
        self,
        player: int,
        announce: Callable[[str], object],
        open_window: "Callable[[], ActiveWindow] | None" = None,
    ) -> None:
        self._player, self._announce = player, announce
        self._open = open_window or _open_window
        self._follower: Follower | None = None
        self._wanted: str | None = None
        self._stamps: dict[Path, Stamp] = {}
        self._due_s = 0.0

    def look(self, now_s: float) -> None:
        """Notices a changed file, and repeats what was told; to be called about once a second.

        Args:
            now_s: present time on a steady clock.
        """
        paths = _list_files(self._player)
        stamps = read_stamps(paths)
        if stamps != self._stamps:
            self._stamps = stamps
            self._begin(next((path for path in paths if path in stamps), None))
        if self._follower is not None and now_s >= self._due_s:
            self._due_s = now_s + TELL_S
            self._tell(self._follower.describe())

    def close(self) -> None:
        """Ends the connection to the desktop. The service forgets it soon."""
        if self._follower is not None:
            self._follower.close()
            self._follower = None

    def _begin(self, path: Path | None) -> None:
        """Follows the windows that a file names, and no others any more."""
        self.close()
        self._wanted = None
        if path is None or not _names_applications(path):
            return  # what reads them takes 30 MB
        from neurotouch_hid.desktop import Follower
        from neurotouch_hid.driver.settings import DriverSettings
        from neurotouch_hid.errors import ProfileError
        from neurotouch_hid.profile.reading import load_settings

        try:
            settings = load_settings(path, DriverSettings)
        except ProfileError as error:
            self._announce(f"Warning: no profile follows a window. {error.message}")
            return
        if settings.applications:
            self._follower = Follower(settings.profile_of, self._open, self._follow)

    def _follow(self, profile: str | None) -> None:
        self._wanted = profile
        self._tell("" if self._follower is None else self._follower.describe())

    def _tell(self, window: str) -> None:
        from neurotouch_hid.client import ask
        from neurotouch_hid.errors import DriverError

        with suppress(DriverError):  # none runs, or one of this person's own, which sees the window
            ask("window", player=self._player, profile=self._wanted, window=window)


def find_desktop(environment: Mapping[str, str]) -> dict[str, str]:
    """Returns the variables that name the desktop.

    This program starts with the session, often before the desktop. Then the desktop gives its
    variables to the person's manager of services, which tells them here.

    Args:
        environment: of this program.
    """
    if any(environment.get(name) for name in _DESKTOP[:2]):
        return dict(environment)
    found = ""
    with suppress(OSError, subprocess.SubprocessError):
        found = subprocess.run(
            ["systemctl", "--user", "show-environment"],  # noqa: S607  # wherever it is
            capture_output=True,
            check=True,
            text=True,
            timeout=_PATIENCE_S,
        ).stdout
    told = dict(line.split("=", 1) for line in found.splitlines() if "=" in line)
    return {**environment, **{name: told[name] for name in _DESKTOP if name in told}}


def _open_window() -> "ActiveWindow":
    from neurotouch_hid.desktop import open_window

    environment = find_desktop(os.environ)
    if "XAUTHORITY" in environment:  # read by the library for X11
        os.environ["XAUTHORITY"] = environment["XAUTHORITY"]
    return open_window(environment)


def _list_files(player: int) -> list[Path]:
    """Returns the files that may name applications, the person's own first."""
    from neurotouch_hid.players import find_machine_folder, find_user_file

    own, machine = find_user_file(player), find_user_file(player, find_machine_folder())
    return [path.with_name("driver.yaml") for path in (own, machine)]


def _names_applications(path: Path) -> bool:
    from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_text

    with suppress(OSError):
        return "applications" in read_text(path, MAX_SETTINGS_BYTES)
    return False
