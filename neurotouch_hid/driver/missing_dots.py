"""Finds the dots that are missing for good, and tells the person once which those are."""

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from threading import Thread
from typing import Final

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.gel_picture import RED, save_picture
from neurotouch_hid.gel_sentences import describe_missing
from neurotouch_hid.messages import Frame, GelState, Step

LOOK_US: Final = 1_000_000
"""A dot that is seen once within this time after the gel is found is not missing for good."""


class MissingDots(Closing):
    """A tap that looks at the gel once, at the start. A thread of its own saves and tells.

    Args:
        announce: is told the sentence; called from that thread.
        learn: takes all missing dots and returns those that the person has not been told of.
        picture: is saved there, with a red box for each missing dot; None: there is no picture.
    """

    def __init__(
        self,
        announce: Callable[[str], object],
        learn: Callable[[frozenset[int]], frozenset[int]],
        picture: Path | None,
    ) -> None:
        self._announce, self._learn, self._picture = announce, learn, picture
        self._gel: GelState | None = None
        self._missing: frozenset[int] = frozenset()
        self._frame: Frame | None = None
        self._begin_us = 0
        self._thread: Thread | None = None

    def __call__(self, step: Step) -> None:
        """Looks which dots are not seen, until it is known which of them never are."""
        if self._thread is not None:
            return
        gel, t_us = step.gel, step.packet.t_end_us
        if not gel.is_found:
            self._gel = None
            return
        if self._gel is None:
            self._missing, self._begin_us = frozenset(gel.missing), t_us
        elif gel is not self._gel:
            self._missing &= frozenset(gel.missing)
        self._gel = gel
        if step.packet.frames:
            self._frame = step.packet.frames[-1]
        if t_us - self._begin_us >= LOOK_US:
            self._thread = Thread(
                target=self._tell, args=(gel, self._missing, self._frame), name="missing dots"
            )
            self._thread.start()

    def close(self) -> None:
        """Waits until everything is saved and told."""
        if self._thread is not None:
            self._thread.join()

    def _tell(self, gel: GelState, missing: frozenset[int], frame: Frame | None) -> None:
        new = self._learn(missing)
        if not new:
            return
        sentence = describe_missing(new, missing, gel.layout)
        places = dict(zip(gel.missing, gel.missing_px, strict=True))
        seen = None
        if self._picture is not None and frame is not None:
            with suppress(OSError, NeuroTouchError):
                boxes = {RED: [places[dot] for dot in sorted(missing)]}
                save_picture(self._picture, frame.pixels, boxes)
                seen = f"Red boxes mark them in {self._picture}."
        self._announce(f"{sentence} {seen or 'To see them: neurotouch doctor'}")
