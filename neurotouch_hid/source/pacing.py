"""Plays a source no faster than it happened."""

import time
from collections.abc import Callable, Iterator
from typing import Final

from neurotouch_hid.closing import Closing
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.source.partial import LEAD_US, cut_partial
from neurotouch_hid.source.protocol import PictureSource, Source
from neurotouch_hid.source.slice_pacer import SlicePacer

STOPPED_NS: Final = 1_000_000_000
"""A packet that took longer, apart from waiting, was not slow: the process was stopped, as by
Ctrl-Z."""


class PacedSource(Closing):
    """Another source at recorded speed.

    The clock starts when the first packet is there; opening and compiling are not made up for. Each
    packet is handed out when as much host time has passed as sensor time up to its end. Every due
    time is counted from the start, so errors of single waits never add up, and a loop
    that was late catches up. A process that was stopped goes on from there: gestures of minutes
    would come all at once. Sensor time that a source left out (a long silence) is not waited for.
    Slices in which nothing happens come as one, and partial slices of others in advance, while
    ``set_activity`` allows it.

    Args:
        source: the other source.
        clock_ns: host time.
        sleep_s: how to wait.
        usual_us: its slices come joined to this length, as those of a camera do unless the gel
            moves; without, as they are.

    Attributes:
        due_ns: the moment on that clock at which the end of the newest packet happened.
    """

    def __init__(
        self,
        source: Source,
        clock_ns: Callable[[], int] = time.monotonic_ns,
        sleep_s: Callable[[float], None] = time.sleep,
        usual_us: int | None = None,
    ) -> None:
        self.name = source.name
        self.rig = source.rig
        self.is_live = source.is_live
        self.is_simulated = source.is_simulated
        self.due_ns = 0
        self._source, self._clock_ns, self._sleep_s = source, clock_ns, sleep_s
        self._pacer, self._is_video = SlicePacer(usual_us), isinstance(source, PictureSource)

    def __iter__(self) -> Iterator[EventPacket]:
        start_ns: int | None = None
        played_us = begun_ns = 0
        for packet in self._join():
            now_ns = self._clock_ns()
            if start_ns is None:
                start_ns = now_ns
            elif (took_ns := now_ns - max(begun_ns, self.due_ns)) > STOPPED_NS:
                start_ns += took_ns
            begun_ns = now_ns
            played_us += packet.t_end_us - packet.t_begin_us
            self.due_ns = start_ns + played_us * 1000
            if self._pacer.takes_partials:
                partial = cut_partial(packet)
                if partial is not None and self._wait(self.due_ns - LEAD_US * 1000):
                    yield partial
            self._wait(self.due_ns)
            yield packet

    def set_activity(
        self,
        *,
        is_idle: bool,
        wants_frames: bool = True,  # noqa: ARG002  # it has them anyway
    ) -> None:
        """Sets whether idle slices may be merged, and partial slices delivered early.

        Not of a video: without events, only a picture shows that something begins.
        """
        if not self._is_video:
            self._pacer.is_idle = is_idle

    def _wait(self, until_ns: int) -> bool:
        """Waits until ``until_ns``; returns False if that has passed already."""
        ahead_ns = until_ns - self._clock_ns()
        if ahead_ns <= 0:
            return False
        self._sleep_s(ahead_ns / 1e9)
        return True

    def _join(self) -> Iterator[EventPacket]:
        for packet in self._source:
            yield from self._pacer.take(packet)
        yield from self._pacer.flush()

    def close(self) -> None:
        """Closes the source that is played."""
        self._source.close()
