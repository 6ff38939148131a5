"""Counts the steps, events and frames of the pipeline, and their rates."""

import time
from dataclasses import dataclass, replace
from typing import Final

from neurotouch_hid.messages import Step
from neurotouch_hid.runtime.stage_timing import StageTimings

WINDOW_S: Final = 1.0
"""Rates are means over this time."""


@dataclass(slots=True)
class Counts:
    """Counts of the steps since the start.

    Attributes:
        slices: finished steps.
        events: events in them.
        frames: frames in them.
        lost: events that the source lost.
        rest_us: the moment of the newest frame that showed the gel at rest; None before the first.
        late_s: how much later the newest step was finished than the promptest one: what waits
            between the sensor and the pipeline.
    """

    slices: int = 0
    events: int = 0
    frames: int = 0
    lost: int = 0
    rest_us: int | None = None
    late_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Rates:
    """Means over the last full window: per second, and host time per slice in ms."""

    slices_hz: float = 0.0
    events_hz: float = 0.0
    frames_hz: float = 0.0
    stage_ms: tuple[tuple[str, float], ...] = ()


class RateMeter:
    """Counts finished steps; the pipeline's thread adds them, any thread may read.

    Args:
        timings: the host time of each stage.

    Attributes:
        counts: since the start.
        rates: the same in a second.
        step_s: the host time of the newest step, or of the start.
    """

    def __init__(self, timings: StageTimings) -> None:
        self.counts = Counts()
        self.rates = Rates()
        self.step_s = time.monotonic()
        self._timings = timings
        self._earliest_s: float | None = None
        self._window = (self.step_s, Counts(), timings.spent_ns)

    def add(self, step: Step) -> bool:
        """Counts a step; returns True when a window is full, so that there are new rates."""
        counts, packet = self.counts, step.packet
        counts.slices += 1
        counts.events += len(packet.events)
        counts.frames += len(packet.frames)
        counts.lost += packet.gap
        if step.rest is not None:
            counts.rest_us = step.rest.t_us
        self.step_s = time.monotonic()
        offset_s = self.step_s - 1e-6 * packet.t_end_us
        if self._earliest_s is None or offset_s < self._earliest_s:
            self._earliest_s = offset_s
        counts.late_s = offset_s - self._earliest_s
        if self.step_s - self._window[0] < WINDOW_S:
            return False
        self._measure()
        return True

    def _measure(self) -> None:
        begun_s, before, before_ns = self._window
        now, now_ns = replace(self.counts), self._timings.spent_ns
        n, took_s = now.slices - before.slices, self.step_s - begun_s
        self.rates = Rates(
            n / took_s,
            (now.events - before.events) / took_s,
            (now.frames - before.frames) / took_s,
            tuple((name, (ns - before_ns[name]) / n / 1e6) for name, ns in now_ns.items()),
        )
        self._window = (self.step_s, now, now_ns)
