"""Measures the pipeline in real time: latency, late slices and cost."""

import math
import time
from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.device import check_device
from neurotouch_hid.driver import REFERENCE, DeviceKind, Driver
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.evaluation.speed.workload import TOUR_US, DenseSource, load_scene
from neurotouch_hid.messages import Step
from neurotouch_hid.process.realtime import realtime_priority
from neurotouch_hid.source.opening import LIVE_US
from neurotouch_hid.source.pacing import PacedSource

LOST_US: Final = 100_000
"""A camera's queue would drop a slice that waits longer than this for the pipeline."""
WARM_S: Final = 1.0
"""Start that is not counted: caches fill, and the gel is found and becomes idle."""

LONG_S: Final = 600.0


@dataclass(frozen=True, slots=True)
class Load:
    """One load of the benchmark.

    Attributes:
        name: name of its figures.
        scene: scene of the simulator, repeated.
        rate_hz: rate of the slices.
        events_per_s: rate of events; if None, as simulated.
        seconds: length of the run.
        sustained: a long benchmark plays it longer.
        follows: the slices follow the activity as those of a camera do; the rate is the highest.
    """

    name: str
    scene: str
    rate_hz: float
    events_per_s: float | None
    seconds: float
    sustained: bool = False
    follows: bool = False


LOADS: Final = (
    Load("at_1_khz", "tour", 1000.0, 1e6, 20.0, sustained=True),
    Load("at_250_hz", "tour", 250.0, 1e6, 20.0, sustained=True),
    Load("at_12_million", "tour", 1000.0, 12e6, 10.0, follows=True),
    Load("play", "tour", 1000.0, None, 20.0, follows=True),
    Load("idle", "rest", 250.0, None, 10.0),
)


def run_live_benchmark(
    method: str, progress: Callable[[str], None], *, long: bool
) -> dict[str, Any]:
    """Returns figures of the pipeline in real time, at the rates and loads that matter.

    Args:
        method: the recogniser.
        progress: called with a sentence at each step.
        long: the sustained rates for ten minutes instead of twenty seconds.

    Returns:
        For each load by its name, the result of ``measure_live``, and under ``machine`` that of
        ``measure_machine``; ``device``, its kind; and of a load that follows the activity,
        ``event_ms``, see ``summarise_waits``.
    """
    kind = choose_device()
    result: dict[str, Any] = {"device": kind}
    for load in LOADS:
        seconds = LONG_S if long and load.sustained else load.seconds
        progress(f"Playing {load.name}, {seconds:.0f} s")
        slice_us = round(1e6 / load.rate_hz)
        scene = load_scene(load.scene, slice_us)
        alone = DenseSource(scene, load.seconds, load.events_per_s)
        machine = measure_machine(alone, is_idle=load.scene == "rest")
        dense = DenseSource(scene, seconds, load.events_per_s)
        dots_us = find_dot_events(load.scene, seconds) if load.follows else None
        result[load.name] = {**measure_live(dense, kind, method, dots_us), "machine": machine}
    return result


def choose_device() -> DeviceKind:
    """Returns ``uinput`` if this machine allows it, else ``memory``."""
    try:
        check_device("uinput")
    except DeviceError:
        return "memory"
    return "uinput"


def measure_live(
    source: DenseSource,
    kind: DeviceKind,
    method: str = "neurotouch",
    dots_us: NDArray[np.int64] | None = None,
) -> dict[str, Any]:
    """Plays a source in real time, as ``run`` does, to a real pad.

    Args:
        source: the source.
        kind: kind of device, see ``choose_device``.
        method: the recogniser.
        dots_us: (n,) int64, times of events whose wait is measured. The slices follow the activity
            then: up to ``LIVE_US`` long, and those of the source while the gel moves.

    Returns:
        ``core``, the processor time of this process over the sensor's, and the result of
        ``summarise_delays``; with ``dots_us`` also ``event_ms``, see ``summarise_waits``. All
        without the first ``WARM_S``.
    """
    paced = PacedSource(source, usual_us=None if dots_us is None else LIVE_US)
    probe = Probe(paced)
    options = replace(REFERENCE, device=kind, speed="recorded", method=method)
    with Driver(options, make_source=lambda: paced) as driver:
        driver.run([probe])
        core = probe.measure_core()
    delays = {**summarise_delays(probe.due_ns, probe.late_ns, probe.waited_ns), "core": core}
    if dots_us is not None:
        delays["event_ms"] = summarise_waits(dots_us, probe.end_us, probe.late_ns)
    return delays


def find_dot_events(name: str, seconds: float) -> NDArray[np.int64]:
    """Returns the times of the events that dots make in a scene that repeats, without noise.

    Args:
        name: name of the scene.
        seconds: sensor time of the whole.

    Returns:
        (n,) int64 µs, ascending.
    """
    most_us = min(TOUR_US, math.ceil(1e6 * seconds))
    packets = load_scene(name, LIVE_US, most_us, is_noisy=False).packets
    once_us = np.concatenate([packet.events["t"] for packet in packets])
    length_us = packets[-1].t_end_us - packets[0].t_begin_us
    return np.concatenate(
        [once_us + k * length_us for k in range(math.ceil(1e6 * seconds / length_us))]
    )


def measure_machine(source: DenseSource, *, is_idle: bool) -> dict[str, Any]:
    """Measures the delay of an empty pipeline: no real one can be faster.

    Args:
        source: the source.
        is_idle: merge slices that contain only noise; else deliver partial slices.

    Returns:
        The result of ``summarise_delays``, from the ends of the slices; and ``core``, the processor
        time of this process over the sensor's.
    """
    paced = PacedSource(source)
    paced.set_activity(is_idle=is_idle)
    due_ns, late_ns = array("q"), array("q")
    with realtime_priority():
        begun_s = time.process_time()
        for packet in paced:
            if not packet.is_partial:
                late_ns.append(time.monotonic_ns() - paced.due_ns)
                due_ns.append(paced.due_ns)
        core = (time.process_time() - begun_s) / source.seconds
    return {**summarise_delays(due_ns, late_ns, late_ns), "core": core}


class Probe:
    """A tap that measures delays; the loop calls it right after it has written the pad.

    Args:
        paced: the source.
        clock_ns: the host's.
        cpu_s: processor time of this process.

    Attributes:
        due_ns: end of each slice.
        end_us: the same in sensor time.
        late_ns: time from the end of each slice to the write.
        waited_ns: the same from its last event.
    """

    def __init__(
        self,
        paced: PacedSource,
        clock_ns: Callable[[], int] = time.monotonic_ns,
        cpu_s: Callable[[], float] = time.process_time,
    ) -> None:
        # Not objects, which Python would look through for garbage now and then.
        self.due_ns, self.late_ns, self.waited_ns = array("q"), array("q"), array("q")
        self.end_us = array("q")
        self._paced, self._clock_ns, self._cpu_s = paced, clock_ns, cpu_s
        self._begin_us: int | None = None
        self._warm: tuple[int, float] | None = None
        self._now_us = 0

    def __call__(self, step: Step) -> None:
        """Notes the time since the slice's end and since its last event, once it is warm."""
        late_ns = self._clock_ns() - self._paced.due_ns
        packet = step.packet
        last_us = int(packet.events["t"][-1]) if len(packet.events) else packet.t_end_us
        self._now_us = packet.t_end_us
        if self._begin_us is None:
            self._begin_us = packet.t_begin_us
        if self._now_us - self._begin_us < WARM_S * 1e6:
            return
        if self._warm is None:
            self._warm = self._now_us, self._cpu_s()
        self.due_ns.append(self._paced.due_ns)
        self.end_us.append(packet.t_end_us)
        self.late_ns.append(late_ns)
        self.waited_ns.append(late_ns + (packet.t_end_us - last_us) * 1_000)

    def measure_core(self) -> float:
        """Returns processor time over sensor time after the warm-up."""
        if self._warm is None or self._warm[0] == self._now_us:
            return 0.0
        warm_us, warm_s = self._warm
        return (self._cpu_s() - warm_s) / (self._now_us - warm_us) * 1e6


def summarise_delays(
    due_ns: Sequence[int], late_ns: Sequence[int], waited_ns: Sequence[int]
) -> dict[str, Any]:
    """Returns the figures of a run's delays.

    Args:
        due_ns: end of each slice.
        late_ns: time from the end of each slice to the write.
        waited_ns: the same from its last event.

    Returns:
        ``latency_ms`` (p50, p99, p99.9 since the last event), ``slices``, ``late`` (ready only
        after the next one was due), ``lost`` (a camera's queue would have dropped them) and
        ``backlog_ms``: by how much the last tenth was later than the first, in the median.
    """
    due, late, waited = (np.array(ns) / 1e6 for ns in (due_ns, late_ns, waited_ns))
    tenth = -(-len(late) // 10)
    p50, p99, p999 = (float(value) for value in np.percentile(waited, [50, 99, 99.9]))
    return {
        "latency_ms": {"p50": p50, "p99": p99, "p99.9": p999},
        "slices": len(late),
        "late": int((late[:-1] > np.diff(due)).sum()),
        "lost": int((late > LOST_US / 1e3).sum()),
        "backlog_ms": float(np.median(late[-tenth:]) - np.median(late[:tenth])),
    }


def summarise_waits(
    t_us: NDArray[np.int64], end_us: Sequence[int], late_ns: Sequence[int]
) -> dict[str, float]:
    """Returns how long events waited from their stamps to the write of their slice.

    Args:
        t_us: (n,) int64, stamps, ascending; those outside of the slices do not count.
        end_us: end of each slice; the first only shows where the second begins.
        late_ns: time from the end of each slice to the write.

    Returns:
        ``mean``, ``p50``, ``p99`` and ``p99.9`` in ms.
    """
    ends_us, late_ms = np.array(end_us), np.array(late_ns) / 1e6
    t_us = t_us[(t_us >= ends_us[0]) & (t_us < ends_us[-1])]
    k = np.searchsorted(ends_us, t_us, side="right")
    wait_ms = (ends_us[k] - t_us) / 1e3 + late_ms[k]
    p50, p99, p999 = (float(value) for value in np.percentile(wait_ms, [50, 99, 99.9]))
    return {"mean": float(wait_ms.mean()), "p50": p50, "p99": p99, "p99.9": p999}
