"""Host time spent in each stage of the pipeline."""

from collections.abc import Sequence
from time import perf_counter_ns
from typing import Final

from neurotouch_hid.runtime.histogram import Histogram

KEPT: Final = 256
"""The newest calls of each stage, kept one by one: a few seconds."""
RANKS: Final = (50.0, 99.0, 99.9)
"""The percentiles that are reported of each stage."""


class StageTimer:
    """The host time of one stage."""

    __slots__ = ("_counted", "_counted_ns", "_newest_ns")

    def __init__(self) -> None:
        self._newest_ns: list[int] = []  # those of the newest calls that are not counted yet
        self._counted, self._counted_ns = Histogram(), 0

    def end(self, begun_ns: int) -> int:
        """Notes a call that ends now, in the thread of the pipeline.

        It is no context manager: Python takes twice as long to enter and to leave one.

        Args:
            begun_ns: its begin, by ``time.perf_counter_ns``.

        Returns:
            The present time, at which the next stage may begin.
        """
        now_ns = perf_counter_ns()
        newest_ns = self._newest_ns
        newest_ns.append(now_ns - begun_ns)
        if len(newest_ns) == 2 * KEPT:  # many at once take less time than each by itself
            self._counted.add(newest_ns[:KEPT])
            self._counted_ns += sum(newest_ns[:KEPT])
            del newest_ns[:KEPT]
        return now_ns

    @property
    def spent_ns(self) -> int:
        """All time spent in the stage, in ns; right in the thread of the pipeline."""
        return self._counted_ns + sum(self._newest_ns)

    @property
    def recent_ns(self) -> list[int]:
        """The newest calls, in ns."""
        return self._newest_ns[-KEPT:]

    def percentiles_ns(self, ranks: Sequence[float]) -> list[float]:
        """Returns percentiles of all calls since the start, in ns."""
        return self._counted.percentiles(ranks, self._newest_ns.copy())


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
        return {name: timer.recent_ns for name, timer in self._timers.items()}

    def spread_ms(self) -> dict[str, tuple[float, ...]]:
        """Returns the ``RANKS`` of all calls since the start, by stage, in ms."""
        return {
            name: tuple(ns / 1e6 for ns in timer.percentiles_ns(RANKS))
            for name, timer in self._timers.items()
        }
