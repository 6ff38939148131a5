"""The profile of the application in front, as the session of the person at the machine tells it."""

import re
import threading
import time
from collections.abc import Callable
from typing import Any, Final

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import DriverError
from neurotouch_hid.printable import make_printable
from neurotouch_hid.vocabulary import NAME_PATTERN

LEASE_S: Final = 6.0
"""What was told counts for this time; ``neurotouch session`` repeats it every two seconds."""

LOOK_S: Final = 1.0
"""Interval of looking whether it still counts."""

MAX_CHARACTERS: Final = 256
_NOBODY: Final = "told by 'neurotouch session', if driver.yaml gives applications a profile"


class ToldWindow(Closing):
    """Follows what one person tells, for as long as that person is at the machine.

    The service sees no desktop. It learns the name of a profile, and a sentence for ``status``,
    which is kept in memory only. No title of a window reaches it.

    Args:
        is_present: returns True if a user, by uid, is the person at the machine.
        follow: called with a profile whenever another one is wanted, with None for an application
            without a profile, and when what was told no longer counts.
        clock: returns the present time in seconds.
    """

    def __init__(
        self,
        is_present: Callable[[int], bool],
        follow: Callable[[str | None], object],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._is_present, self._follow, self._clock = is_present, follow, clock
        self._lock = threading.Lock()  # clients ask in threads of their own
        self._uid: int | None = None
        self._wanted: str | None = None
        self._said = _NOBODY
        self._until_s = 0.0
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="window", daemon=True)
        self._thread.start()

    def tell(self, uid: int, question: dict[str, Any]) -> None:
        """Takes what a person's session tells.

        Args:
            uid: the user who tells it, as the kernel says.
            question: ``profile``: the name of the wanted profile, or None; ``window``: a sentence
                about the application in front.

        Raises:
            DriverError: the user is not at the machine, or these are no names.
        """
        if not self._is_present(uid):
            raise DriverError(
                "The service follows the windows of the person at the machine, and that is not you."
            )
        profile, window = question.get("profile"), question.get("window")
        is_name = isinstance(profile, str) and re.fullmatch(NAME_PATTERN, profile)
        if not (profile is None or is_name) or not isinstance(window, str):
            raise DriverError("A profile's name and a sentence about the window are needed.")
        with self._lock:
            self._uid, self._said = uid, make_printable(window[:MAX_CHARACTERS])
            self._until_s = self._clock() + LEASE_S
            self._go_on_with(profile)

    def check(self) -> None:
        """Forgets what was told if it no longer counts."""
        with self._lock:
            if self._uid is None:
                return
            if self._clock() > self._until_s or not self._is_present(self._uid):
                self._uid, self._said = None, _NOBODY
                self._go_on_with(None)

    def describe(self) -> str:
        """Returns what was told of the application in front."""
        return self._said

    def close(self) -> None:
        """Ends the thread that looks."""
        self._done.set()
        self._thread.join()

    def _go_on_with(self, profile: str | None) -> None:
        if profile != self._wanted:
            self._wanted = profile
            self._follow(profile)

    def _watch(self) -> None:
        while not self._done.wait(LOOK_S):
            self.check()
