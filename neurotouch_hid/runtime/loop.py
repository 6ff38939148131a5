"""The loop around the line: source in, device out, taps beside, neutral when anything is wrong."""

import threading
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from neurotouch_hid.device import Device
from neurotouch_hid.errors import DeviceError, GelNotFoundError
from neurotouch_hid.messages import EventPacket, Step
from neurotouch_hid.runtime.pipeline import Pipeline
from neurotouch_hid.source import ActivityAware, LiveSource

if TYPE_CHECKING:
    from neurotouch_hid.runtime.session import Session

STALL_S = 0.2
"""Silence of the source after which the pad goes neutral: twenty slices of 10 ms."""
LIVE_STALL_S = 0.08
"""The same for a camera, which says something at least every 33 ms, and whose unplugging must show
within 100 ms. A recording or a simulation has no such beat, and nobody's hand on it."""

Tap = Callable[[Step], None]
"""Reads Steps and never feeds back."""


@dataclass(frozen=True, slots=True)
class LoopStats:
    """What a run did: slices, events and sensor time that went through, and host time it took."""

    slices: int
    events: int
    sensor_s: float
    host_s: float


def run_pipeline(
    source: Iterable[EventPacket],
    pipeline: Pipeline,
    device: Device,
    taps: Iterable[Tap] = (),
    *,
    stop: threading.Event | None = None,
    session: "Session | None" = None,
    turned: Callable[[], object] | None = None,
) -> LoopStats:
    """Drives the pad until the source ends or ``stop`` is set; the pad is neutral afterwards.

    What others order through ``session`` is done between two slices. While a live source has
    nothing, the loop turns all the same, so that it obeys and ends.

    Args:
        source: what to play.
        pipeline: the line.
        device: the pad.
        taps: read every Step.
        stop: ends the loop.
        session: what the line obeys.
        turned: called after every turn of the loop, also one without a slice.

    Raises:
        GelNotFoundError: the source ended and no frame showed the gel.
    """
    taps = tuple(taps)
    turns: Iterable[EventPacket | None] = source
    stall_s = STALL_S
    if isinstance(source, LiveSource):
        turns, stall_s = source.turns(), LIVE_STALL_S
    aware = source if pipeline.is_live and isinstance(source, ActivityAware) else None
    slices = events = 0
    first_us = last_us = None
    begun = time.perf_counter()
    try:
        with _StallGuard(device, stall_s) as guard:
            for packet in turns:
                if session is not None:
                    session.obey()
                if packet is not None and packet.is_partial:
                    pipeline.advance_partial(packet)
                elif packet is not None:
                    step = pipeline.advance(packet)
                    device.write(step.pad)
                    guard.feed()
                    if session is not None:
                        session.note(step)
                    for tap in taps:
                        tap(step)
                    pipeline.process_frames(step)
                    if aware is not None:
                        aware.set_activity(
                            is_idle=pipeline.is_idle, wants_frames=not pipeline.is_at_rest
                        )
                    slices += 1
                    events += len(packet.events)
                    first_us = packet.t_begin_us if first_us is None else first_us
                    last_us = packet.t_end_us
                if turned is not None:
                    turned()
                if stop is not None and stop.is_set():
                    break
    finally:
        device.neutral()
        pipeline.close()
    if stop is None or not stop.is_set():
        _require_gel(pipeline)
    sensor_s = 0.0 if first_us is None or last_us is None else (last_us - first_us) / 1e6
    return LoopStats(slices, events, sensor_s, time.perf_counter() - begun)


def _require_gel(pipeline: Pipeline) -> None:
    seen = pipeline.rest.detector.stats()
    if not seen.n_references:
        raise GelNotFoundError(
            f"No gel can be seen in this source: {seen.reason}.",
            hint="Is the LED ring on, the lens cap off, and no hand on the gel at the start?",
        )


class _StallGuard:
    """Sends neutral when the line has not been fed for so long, or when the machine has slept."""

    def __init__(self, device: Device, stall_s: float) -> None:
        self._device = device
        self._stall_s = stall_s
        self._fed = time.monotonic()
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="stall guard", daemon=True)

    def __enter__(self) -> "_StallGuard":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._done.set()
        self._thread.join()

    def feed(self) -> None:
        self._fed = time.monotonic()

    def _watch(self) -> None:
        asleep, wait_s = _time_asleep(), self._stall_s
        while not self._done.wait(wait_s):
            slept = _time_asleep() - asleep > self._stall_s
            if slept:
                asleep = _time_asleep()
            left_s = self._fed + self._stall_s - time.monotonic()
            if slept or left_s <= 0:
                with suppress(DeviceError):  # the line's own next write meets and reports it
                    self._device.neutral()
            wait_s = left_s if left_s > 0 else self._stall_s


def _time_asleep() -> float:
    """Seconds the machine has spent in suspend since boot."""
    return time.clock_gettime(time.CLOCK_BOOTTIME) - time.clock_gettime(time.CLOCK_MONOTONIC)
