"""Gives each application the profile that the person has chosen for it."""

import select
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Final

from neurotouch_hid.desktop.window import ActiveWindow
from neurotouch_hid.errors import DesktopError
from neurotouch_hid.printable import make_printable

POLL_S: Final = 0.2
"""Interval of asking a desktop that does not tell by itself: a change counts within 0.3 s."""

TOLD_S: Final = 0.5
"""The longest wait for a desktop that tells; the driver may end meanwhile."""

SETTLE_S: Final = 0.05
"""Between two windows some desktops tell of none for a moment. That must not release the pad."""

AGAIN_S: Final = 5.0
"""Interval at which a desktop that does not answer is asked again: it may still be starting."""

CLOSE_S: Final = 3.0
"""Longer than any desktop that answers takes."""


class Follower:
    """Watches the active window in a separate thread.

    Args:
        profiles: the profile of each application, by a name of its windows; case does not count.
        open_window: connects to the desktop.
        follow: called with a profile whenever the wanted one changes; with None for an application
            without a profile.
    """

    def __init__(
        self,
        profiles: Mapping[str, str],
        open_window: Callable[[], ActiveWindow],
        follow: Callable[[str | None], object],
    ) -> None:
        self._profiles = {window.lower(): profile for window, profile in profiles.items()}
        self._open = open_window
        self._follow = follow
        self._wanted: str | None = None
        self._said = "not asked yet"
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="desktop", daemon=True)
        self._thread.start()

    def describe(self) -> str:
        """Returns the active application, or why it is unknown."""
        return self._said

    def close(self) -> None:
        """Ends the thread; does not wait for a desktop that hangs."""
        self._done.set()
        self._thread.join(CLOSE_S)

    def _watch(self) -> None:
        while not self._done.is_set():
            try:
                window = self._open()
            except DesktopError as error:
                self._said = " ".join(filter(None, (error.message, error.hint)))
            else:
                self._look_at(window)
                with suppress(DesktopError):
                    window.close()
            self._done.wait(AGAIN_S)

    def _look_at(self, window: ActiveWindow) -> None:
        """Follows the window until the desktop goes away or the driver ends."""
        while not self._done.is_set():
            try:
                names = window.names()
            except DesktopError as error:
                self._said = error.message
                return
            found = [
                self._profiles[name.lower()] for name in names if name.lower() in self._profiles
            ]
            wanted = found[0] if found else None
            seen = make_printable("/".join(names)) or "no window"
            self._said = f"{seen} is in front ({window.desktop})"
            if wanted != self._wanted:
                self._wanted = wanted
                self._follow(wanted)
            self._wait(window)

    def _wait(self, window: ActiveWindow) -> None:
        """Returns when another window may be active."""
        if window.fd is None:
            self._done.wait(POLL_S)
        elif select.select([window.fd], [], [], TOLD_S)[0]:
            self._done.wait(SETTLE_S)
