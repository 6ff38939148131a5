"""Plays one cue after another in a separate thread."""

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Final

from neurotouch_hid.monitor.cue import Cue
from neurotouch_hid.monitor.sound_programs import play_cue
from neurotouch_hid.profile.schema import SoundName

GAP_S: Final = 0.12
"""Shortest time between the starts of two sounds: closer ones blur, and each costs a process."""

CLOSE_S: Final = 6.0
"""Longer than the time limits of all players together."""


class Speaker:
    """A thread that plays the newest cue.

    Its queue has room for one cue, and the newest wins: a player that is slow or hangs loses
    sounds, but never delays the thread that posts them.

    Args:
        announce: called once, in the thread, with a sentence for the person, if no sound is
            possible.

    Attributes:
        sentence: the program that played the last cue, or why none did; empty before the first.
    """

    def __init__(self, announce: Callable[[str], object]) -> None:
        self._announce = announce
        self._queue: deque[tuple[Cue, SoundName, int]] = deque(maxlen=1)
        self._wake = threading.Event()
        self._stopped = threading.Event()
        self._said: set[str] = set()
        self.sentence = ""
        self._thread = threading.Thread(target=self._work, name="sound", daemon=True)
        self._thread.start()

    def play(self, cue: Cue, mode: SoundName, volume: int) -> None:
        """Posts a cue; never waits.

        Args:
            cue: the cue.
            mode: ``tones`` or ``speech``; with ``none`` nothing happens.
            volume: 0 to 100 percent; 0 is silence.
        """
        if mode != "none" and volume:
            self._queue.append((cue, mode, volume))
            self._wake.set()

    def close(self) -> None:
        """Ends the thread, after the present sound."""
        self._stopped.set()
        self._wake.set()
        self._thread.join(CLOSE_S)

    def _work(self) -> None:
        while True:
            self._wake.wait()
            self._wake.clear()
            if self._stopped.is_set():
                return
            if self._queue:
                begun = time.monotonic()
                self._play(*self._queue.pop())
                self._stopped.wait(max(0.0, begun + GAP_S - time.monotonic()))

    def _play(self, cue: Cue, mode: SoundName, volume: int) -> None:
        outcome = play_cue(cue, mode, volume)
        self.sentence = outcome.sentence
        if not outcome.played and outcome.sentence not in self._said:
            self._said.add(outcome.sentence)
            self._announce(f"Warning: {outcome.sentence}.")
