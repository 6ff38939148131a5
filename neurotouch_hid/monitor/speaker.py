"""Plays one cue after another beside whatever makes them."""

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Final

from neurotouch_hid.monitor.cue import Cue
from neurotouch_hid.monitor.sound_programs import play_cue
from neurotouch_hid.profile.schema import SoundName

GAP_S: Final = 0.12
"""Between the starts of two sounds: closer ones are a noise, and each costs a process."""

CLOSE_S: Final = 6.0
"""More than all players in a row may take before they are ended."""


class Speaker:
    """A thread that plays the newest cue.

    The queue before it has one cue and the newest wins: a player that is slow or hangs loses
    sounds, never time of who posts them.

    Args:
        announce: tells the person a sentence, once, when no sound can be made; called in the
            thread.

    Attributes:
        sentence: how the last cue was played, or why it was not; empty before the first.
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
            cue: what to play.
            mode: ``tones`` or ``speech``; with ``none`` nothing happens.
            volume: 0 to 100 percent; 0 is silence.
        """
        if mode != "none" and volume:
            self._queue.append((cue, mode, volume))
            self._wake.set()

    def close(self) -> None:
        """Ends the thread; a sound that is being played may end first."""
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
