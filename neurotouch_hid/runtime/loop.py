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

if TYPE_CHECKING:
    from neurotouch_hid.runtime.session import Session

STALL_S = 0.2
"""Silence of the source after which the pad goes neutral: twenty slices of 10 ms."""

Tap = Callable[[Step], None]
"""Reads Steps and never feeds back."""


@dataclass(frozen=True, slots=True)
class LoopStats:
    """What a run did: slices, events and sensor time that went through, and host time it took."""

    slices: int
    events: int
    sensor_s: float
    host_s: float


def run_line(
    source: Iterable[EventPacket],
    pipeline: Pipeline,
    device: Device,
    taps: Iterable[Tap] = (),
    *,
    stop: threading.Event | None = None,
    session: "Session | None" = None,
) -> LoopStats:
    """Drives the pad until the source ends or ``stop`` is set; the pad is neutral afterwards.

    What others order through ``session`` is done between two slices.

    Raises:
        GelNotFoundError: the source ended and no frame showed the gel.
    """
    taps = tuple(taps)
    slices = events = 0
    first_us = last_us = None
    begun = time.perf_counter()
    try:
        with _StallGuard(device) as guard:
            for packet in source:
                if session is not None:
                    session.obey()
                step = pipeline.advance(packet)
                device.write(step.pad)
                guard.feed()
                if session is not None:
                    session.note(step)
                for tap in taps:
                    tap(step)
                slices += 1
                events += len(packet.events)
                first_us = packet.t_begin_us if first_us is None else first_us
                last_us = packet.t_end_us
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
    """Sends neutral when the line has not turned for ``STALL_S``, or when the machine has slept."""

    def __init__(self, device: Device) -> None:
        self._device = device
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
        asleep = _time_asleep()
        while not self._done.wait(STALL_S / 4):
            slept = _time_asleep() - asleep > STALL_S
            if slept:
                asleep = _time_asleep()
            if slept or time.monotonic() - self._fed > STALL_S:
                with suppress(DeviceError):  # the line's own next write meets and reports it
                    self._device.neutral()


def _time_asleep() -> float:
    """Seconds the machine has spent in suspend since boot."""
    return time.clock_gettime(time.CLOCK_BOOTTIME) - time.clock_gettime(time.CLOCK_MONOTONIC)
