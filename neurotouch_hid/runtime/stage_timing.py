"""Host time spent in each stage of the pipeline."""

from collections import deque
from time import perf_counter_ns
from typing import Final

from neurotouch_hid.runtime.histogram import Histogram

KEPT: Final = 256
"""The newest calls of each stage, kept one by one: a few seconds."""
RANKS: Final = (50.0, 99.0, 99.9)
"""The percentiles that are reported of each stage."""


class StageTimer:
    """The host time of one stage.

    Attributes:
        spent_ns: all time spent in the stage, in ns.
        recent_ns: the newest calls, in ns.
        all_ns: all calls since the start.
    """

    __slots__ = ("all_ns", "recent_ns", "spent_ns")

    def __init__(self) -> None:
        self.spent_ns = 0
        self.recent_ns: deque[int] = deque(maxlen=KEPT)
        self.all_ns = Histogram()

    def end(self, begun_ns: int) -> int:
        """Counts a call that ends now, in the thread of the pipeline.

        It is no context manager: Python takes twice as long to enter and to leave one.

        Args:
            begun_ns: its begin, by ``time.perf_counter_ns``.

        Returns:
            The present time, at which the next stage may begin.
        """
        now_ns = perf_counter_ns()
        took_ns = now_ns - begun_ns
        self.spent_ns += took_ns
        self.recent_ns.append(took_ns)
        self.all_ns.add(took_ns)
        return now_ns


class StageTimings:
    """A timer for each stage of a pipeline; the figures may be read from any thread.

    ``status`` and the page show them under the names of ``_timers``.
    """

    def __init__(self) -> None:
        self.rest, self.tracker, self.gesture = StageTimer(), StageTimer(), StageTimer()
        self.profile, self.device = StageTimer(), StageTimer()
        self.partial, self.frames = StageTimer(), StageTimer()
        self._timers: Final = {
            "rest": self.rest,
            "head": self.partial,  # the name that ``status`` has always given it
            "tracker": self.tracker,
            "frames": self.frames,
            "gesture": self.gesture,
            "profile": self.profile,
            "device": self.device,
        }

    @property
    def spent_ns(self) -> dict[str, int]:
        """All time spent in each stage since the start, in ns."""
        return {name: timer.spent_ns for name, timer in self._timers.items()}

    def recent_ns(self) -> dict[str, list[int]]:
        """Returns how long each of the newest calls took, by stage, in ns."""
        return {name: list(timer.recent_ns.copy()) for name, timer in self._timers.items()}

    def spread_ms(self) -> dict[str, tuple[float, ...]]:
        """Returns the ``RANKS`` of all calls since the start, by stage, in ms."""
        return {
            name: tuple(ns / 1e6 for ns in timer.all_ns.percentiles(*RANKS))
            for name, timer in self._timers.items()
        }
