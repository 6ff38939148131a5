"""Measures the time from the last event of a slice until another program has read its input."""

import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.device import check_device, shows_change
from neurotouch_hid.driver import REFERENCE, DeviceKind, Driver
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import EventPacket, GamepadState
from neurotouch_hid.process.own_command import make_own_command
from neurotouch_hid.process.realtime import realtime_priority
from neurotouch_hid.source import open_source

SCENE: Final = "sim:random"
PROFILE: Final = "spacecraft"
SECONDS: Final = 20.0
PLACE: Final = "neurotouch/pad0"
"""Physical path of the measured pad, which is the first player's."""

EDGES_MS: Final = (0.25, 0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 20.0, 50.0)
"""Bounds of the histogram's bins."""

_AHEAD_S: Final = 0.5
_KEPT_US: Final = 2


@dataclass(frozen=True, slots=True)
class Latency:
    """A distribution of times, in ms.

    Attributes:
        n: number of times.
        p50: half are shorter.
        p99: 99 % are shorter.
        p999: 99.9 % are shorter.
        most: the longest.
        histogram: number of times up to each of EDGES_MS, and above the last.
    """

    n: int
    p50: float
    p99: float
    p999: float
    most: float
    histogram: tuple[int, ...]

    @classmethod
    def of(cls, times_ms: NDArray[np.float64]) -> "Latency":
        """Returns the distribution of these times, at least one."""
        p50, p99, p999 = (float(value) for value in np.percentile(times_ms, [50, 99, 99.9]))
        bins = np.histogram(times_ms, [-np.inf, *EDGES_MS, np.inf])[0]
        return cls(len(times_ms), p50, p99, p999, float(times_ms.max()), tuple(map(int, bins)))

    def as_json(self) -> dict[str, Any]:
        """Returns the same for programs."""
        edges = [*EDGES_MS, None]
        return {
            "n": self.n,
            **{f"{name}_ms": round(getattr(self, name), 4) for name in ("p50", "p99", "p999")},
            "max_ms": round(self.most, 4),
            "histogram": [
                {"up_to_ms": edge, "n": n} for edge, n in zip(edges, self.histogram, strict=True)
            ],
        }


@dataclass(frozen=True, slots=True)
class Sent:
    """A slice after which the pad changed; moments in ns of CLOCK_MONOTONIC."""

    t_us: int
    last_event_ns: int
    written_ns: int


def measure_latency(
    kind: DeviceKind,
    method: str,
    progress: Callable[[str], None],
    *,
    source: str = SCENE,
    seconds: float = SECONDS,
) -> dict[str, Any]:
    """Plays slices in real time to a real pad, and reads it in another process.

    The slices are made beforehand, so that a simulator does not compete with the pipeline.

    Args:
        kind: ``uinput`` or ``hid``.
        method: the method of recognition.
        progress: called with a sentence at each step.
        source: the source.
        seconds: largest sensor time.

    Returns:
        ``line`` (from the last event of a slice to the reader) and ``device`` (from our write to
        the reader), see ``Latency.as_json``; ``frames``, the number of changes of the pad; and
        ``sensor_time_kept``, the share of frames whose stamps are as far apart as the sensor's.

    Raises:
        DeviceError: no pad can be made or read, or nothing moved it.
    """
    check_device(kind)
    progress(f"Preparing {seconds:g} s of {source}")
    packets = _prepare(source, seconds)
    options = replace(
        REFERENCE, source=source, speed="recorded", profile=PROFILE, device=kind, method=method
    )
    with Driver(options) as driver:
        reader = _start_reader()
        progress("Playing it to a real pad")
        try:
            with realtime_priority():
                sent = _play(packets, driver)
        finally:
            driver.close()  # which ends the reader
            received = _collect(reader)
    if not sent or len(received) < len(sent):
        raise DeviceError(
            f"Of {len(sent)} changes of the pad {len(received)} arrived.",
            hint="Does another program press the pad, or is the machine overloaded?",
        )
    return evaluate(sent, received[: len(sent)])


def evaluate(sent: Sequence[Sent], received: Sequence[tuple[int, int]]) -> dict[str, Any]:
    """Returns the distributions of the times between sending and receiving.

    Args:
        sent: the slices.
        received: for each the kernel's stamp and the moment of reading, in ns.
    """
    stamps, read = np.array(received, np.int64).T
    events = np.array([each.last_event_ns for each in sent])
    writes = np.array([each.written_ns for each in sent])
    steps_us = np.diff([each.t_us for each in sent])
    kept = np.abs(np.diff(stamps) // 1_000 - steps_us) <= _KEPT_US
    return {
        "line": Latency.of((read - events) / 1e6).as_json(),
        "device": Latency.of((read - writes) / 1e6).as_json(),
        "frames": len(sent),
        "sensor_time_kept": round(float(kept.mean()), 4) if len(kept) else None,
    }


def _prepare(source: str, seconds: float) -> list[EventPacket]:
    with open_source(source, speed="max") as packets:
        begin_us: int | None = None

        def is_early(packet: EventPacket) -> bool:
            nonlocal begin_us
            begin_us = packet.t_begin_us if begin_us is None else begin_us
            return packet.t_begin_us - begin_us < seconds * 1e6

        return list(takewhile(is_early, packets))


def _play(packets: list[EventPacket], driver: Driver) -> list[Sent]:
    """Yields each slice at the moment in which a sensor would have finished it."""
    sent = []
    shown = GamepadState(0)
    offset_ns = time.monotonic_ns() + round(_AHEAD_S * 1e9) - packets[0].t_begin_us * 1_000
    for packet in packets:
        wait_s = (packet.t_end_us * 1_000 + offset_ns - time.monotonic_ns()) / 1e9
        if wait_s > 0:
            time.sleep(wait_s)
        step = driver.pipeline.advance(packet)
        pad, written_ns = step.pad, time.monotonic_ns()
        driver.device.write(pad)
        driver.pipeline.finish(step)
        if shows_change(shown, pad):
            # A slice without events changes the pad when its time is over.
            last_us = int(packet.events["t"][-1]) if len(packet.events) else packet.t_end_us
            sent.append(Sent(packet.t_end_us, last_us * 1_000 + offset_ns, written_ns))
        shown = pad
    return sent


def _start_reader() -> "subprocess.Popen[str]":
    command = make_own_command(PLACE, module="neurotouch_devtools.bench.receiver")
    reader = subprocess.Popen(  # noqa: S603  # our own command
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert reader.stdout is not None  # noqa: S101
    if reader.stdout.readline() != "ready\n":
        said = reader.communicate()[1].strip()
        raise DeviceError(
            f"The pad cannot be read back: {said}.",
            hint="Log in at the machine itself; over ssh, join the group input and log in again.",
        )
    return reader


def _collect(reader: "subprocess.Popen[str]") -> list[tuple[int, int]]:
    said, complaint = reader.communicate(timeout=30)
    if reader.returncode:
        raise DeviceError(f"The reading program failed: {complaint.strip()}.")
    return [(int(stamp), int(at)) for stamp, at in map(str.split, said.splitlines())]
