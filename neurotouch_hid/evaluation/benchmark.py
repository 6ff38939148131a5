"""How fast the line is on this machine, stage by stage and as a whole."""

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.gesture import GestureConfig, GestureRecognizer, Method
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.profile import load_profile
from neurotouch_hid.recording import RecordingWriter
from neurotouch_hid.runtime import Pipeline, warm_up
from neurotouch_hid.source import open_source
from neurotouch_hid.tracker import MarkerTracker, RestDetector

SCENE = "random"
"""All gestures of all kinds of users, with pauses between them."""
FAST_SCENE = "fast"
"""The paper's largest motions at its largest speeds, 18 mm at 210 mm/s: the most events."""
PREPARED_S = 20.0
"""Sensor time of what is played, at most."""
READY, PLAYED = "Gamepad ready", "Played "
"""What ``neurotouch run`` prints when the pad is there, and when all is played."""


@dataclass(frozen=True, slots=True)
class Spread:
    """Median and 99th percentile. For a rate, the p99 is what 99 % of the slices exceed."""

    median: float
    p99: float

    @classmethod
    def of(cls, values: NDArray[np.float64], *, rate: bool = False) -> "Spread":
        """The spread of measured values."""
        return cls(float(np.median(values)), float(np.percentile(values, 1 if rate else 99)))

    def as_json(self) -> dict[str, float]:
        """The same for programs."""
        return {"median": self.median, "p99": self.p99}


def run_benchmark(method: Method, progress: Callable[[str], None]) -> dict[str, Any]:
    """Measures everything, one thread, nothing else running.

    Args:
        method: how gestures are recognised.
        progress: called with what is being done.

    Returns:
        ``tracker_events_per_s`` (of the fast scene), ``gesture_ms``, ``rest_ms``, ``advance_ms``
        (each median and p99, per slice of 10 ms or per frame), ``events_per_s`` of the other scene,
        ``realtime_factor`` of a recording played through the whole line as fast as possible,
        ``startup_s`` (``help_cpu``: processor time of ``neurotouch --help``; ``pad``: from the
        start of ``run`` to the pad) and ``rss_mb``, the most memory that playing it took.
    """
    config = GestureConfig(method=method)
    progress(f"Simulating {PREPARED_S:.0f} s of gestures")
    packets = _simulate(SCENE)
    fast = _simulate(FAST_SCENE)
    warm_up(Pipeline.build(load_profile("default"), config))
    progress("Measuring the stages")
    result: dict[str, Any] = {
        "tracker_events_per_s": _measure_tracker(fast),
        **_measure_stages(packets, config),
    }
    progress("Measuring the whole line")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bench.aedat4"
        with RecordingWriter(path) as writer:
            for packet in packets:
                writer.write(packet)
        result |= _measure_whole(path, method)
    progress("Measuring the start")
    result["startup_s"] = _measure_start(method)
    return result


def _simulate(scene: str) -> list[EventPacket]:
    packets = []
    with open_source(f"sim:{scene}", speed="max") as source:
        for packet in source:
            packets.append(packet)
            if packet.t_end_us >= PREPARED_S * 1e6:
                break
    return packets


def _measure_tracker(packets: list[EventPacket]) -> dict[str, float]:
    """Events a second through the tracker, its checks and frames included."""
    rest, tracker, rate = RestDetector(), MarkerTracker(), []
    for packet in packets:
        for frame in packet.frames:
            answer = rest.update(frame)
            if answer is not None:
                tracker.anchor(answer)
        begun = time.perf_counter()
        tracker.update(packet)
        if len(packet.events) >= 2_000:  # a slice with little in it measures the call, not the loop
            rate.append(len(packet.events) / (time.perf_counter() - begun))
    return Spread.of(np.array(rate), rate=True).as_json()


def _measure_stages(packets: list[EventPacket], config: GestureConfig) -> dict[str, Any]:
    """Each stage alone on what the stage before gave, then all together."""
    rest, tracker, recognizer = RestDetector(), MarkerTracker(), GestureRecognizer(config)
    rest_ms, gesture_ms = [], []
    for packet in packets:
        answer = None
        for frame in packet.frames:
            begun = time.perf_counter()
            answer = rest.update(frame)
            rest_ms.append((time.perf_counter() - begun) * 1e3)
        if answer is not None:
            tracker.anchor(answer)
        markers = tracker.update(packet)
        begun = time.perf_counter()
        recognizer.update(markers)
        gesture_ms.append((time.perf_counter() - begun) * 1e3)
    line = Pipeline.build(load_profile("default"), config)
    advance_ms = []
    for packet in packets:
        begun = time.perf_counter()
        line.advance(packet)
        advance_ms.append((time.perf_counter() - begun) * 1e3)
    n_events = sum(len(packet.events) for packet in packets)
    return {
        "gesture_ms": Spread.of(np.array(gesture_ms)).as_json(),
        "rest_ms": Spread.of(np.array(rest_ms)).as_json(),
        "advance_ms": Spread.of(np.array(advance_ms)).as_json(),
        "events_per_s": n_events / PREPARED_S,
    }


def _measure_whole(path: Path, method: str) -> dict[str, float]:
    """Plays a recording in a process of its own: its pace without the start, and its memory."""
    _reap(_start_run(f"file:{path}", method))  # compiles what a file needs beyond the simulator
    process = _start_run(f"file:{path}", method)
    _wait_for(READY, process)
    ready = time.perf_counter()
    _wait_for(PLAYED, process)
    took_s = time.perf_counter() - ready
    rss_mb = _read_peak_mb(process.pid)  # it still has to tidy up
    _reap(process)
    return {"realtime_factor": PREPARED_S / took_s, "rss_mb": rss_mb}


def _read_peak_mb(pid: int) -> float:
    """The most memory a process had so far, 0 once it has ended.

    Not ``ru_maxrss``, which begins with the memory of the process that started it.
    """
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmHWM"):
            return int(line.split()[1]) / 1024
    return 0.0


def _measure_start(method: str) -> dict[str, float]:
    help_cpu, pad = [], []
    for _ in range(5):
        usage = _reap(_start(["--help"]))
        help_cpu.append(usage.ru_utime + usage.ru_stime)
        begun = time.perf_counter()
        process = _start_run("sim:rest", method)
        _wait_for(READY, process)
        pad.append(time.perf_counter() - begun)
        process.terminate()
        _reap(process)
    return {"help_cpu": float(np.median(help_cpu)), "pad": float(np.median(pad))}


def _start_run(source: str, method: str) -> subprocess.Popen[str]:
    options = ["--source", source, "--speed", "max", "--device", "memory", "--method", method]
    return _start(["run", "--show", "nothing", *options])


def _start(arguments: list[str]) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "neurotouch_hid", *arguments]
    return subprocess.Popen(  # noqa: S603  # our own command
        command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )


def _wait_for(words: str, process: subprocess.Popen[str]) -> None:
    for line in process.stderr or ():
        if line.startswith(words):
            return


def _reap(process: subprocess.Popen[str]) -> resource.struct_rusage:
    """Waits for the end of a process and returns what it used.

    Raises:
        NeuroTouchError: it did not end well, so its figures would mean nothing.
    """
    said = "".join(process.stderr or ())
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise NeuroTouchError(f"A measured process failed: {said.strip()}")
    return usage
