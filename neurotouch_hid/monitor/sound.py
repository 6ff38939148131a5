"""Lets the person hear what the gestures do, beside the line."""

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Final

from neurotouch_hid.messages import Step
from neurotouch_hid.monitor.cue import Cue, CueFinder, choose_volume
from neurotouch_hid.monitor.player import play_cue
from neurotouch_hid.profile.feedback import SoundName
from neurotouch_hid.runtime import Session

GAP_S: Final = 0.12
"""Between the starts of two sounds: closer ones are a noise, and each costs a process."""

CLOSE_S: Final = 6.0
"""More than all players in a row may take before they are ended."""


class SoundMonitor:
    """A tap with a thread that plays what the person's ``feedback`` asks for.

    The mailbox between them holds one cue and the newest wins: a player that is slow or hangs
    loses sounds, never time of the line.

    Args:
        session: the running line, and the person's values that hold.
        announce: tells the person a sentence, once, when no sound can be made; called in the
            thread.
    """

    def __init__(self, session: Session, announce: Callable[[str], None]) -> None:
        self._session = session
        self._announce = announce
        self._finder = CueFinder(session.mapping)
        self._mailbox: deque[tuple[Cue, SoundName, int]] = deque(maxlen=1)
        self._wake = threading.Event()
        self._stopped = threading.Event()
        self._said: set[str] = set()
        self._outcome = ""
        self._thread = threading.Thread(target=self._work, name="sound", daemon=True)
        self._thread.start()

    def __call__(self, step: Step) -> None:
        """Posts what is to be heard of ``step``; never waits."""
        mapping, user = self._session.mapping, self._session.user
        cues, sound = self._finder.find(step, mapping), user.feedback.sound
        if sound == "none":
            return
        for cue in cues:
            volume = choose_volume(cue.kind, user, mapping)
            if volume:
                self._mailbox.append((cue, sound, volume))
                self._wake.set()
                return

    def describe(self) -> str:
        """What is heard, or why nothing is."""
        sound = self._session.user.feedback.sound
        return self._outcome if sound != "none" and self._outcome else sound

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
            if self._mailbox:
                begun = time.monotonic()
                self._play(*self._mailbox.pop())
                self._stopped.wait(max(0.0, begun + GAP_S - time.monotonic()))

    def _play(self, cue: Cue, mode: SoundName, volume: int) -> None:
        outcome = play_cue(cue, mode, volume)
        self._outcome = outcome.sentence
        if not outcome.played and outcome.sentence not in self._said:
            self._said.add(outcome.sentence)
            self._announce(f"Warning: {outcome.sentence}.")
