"""Measures the speed of the pipeline on this machine, stage by stage and as a whole."""

import gc
import os
import resource
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.driver import REFERENCE, Driver, DriverOptions
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.evaluation.accuracy.files import evaluate_files
from neurotouch_hid.evaluation.speed.decoding import measure_decoding
from neurotouch_hid.evaluation.speed.pace import run_live_benchmark
from neurotouch_hid.gesture import GestureConfig, GestureRecognizer
from neurotouch_hid.messages import (
    SENSOR_HEIGHT_PX,
    SENSOR_WIDTH_PX,
    EventPacket,
    GestureKind,
    Truth,
)
from neurotouch_hid.process.gc_freeze import freeze_gc
from neurotouch_hid.process.own_command import make_own_command, make_own_python
from neurotouch_hid.profile import Mapping, load_profile
from neurotouch_hid.recording import RecordingWriter, labels_path, write_labels
from neurotouch_hid.source import open_source
from neurotouch_hid.source.view import View, ViewTable
from neurotouch_hid.tracker import MarkerTracker, RestDetector, TrackerConfig

SCENE = "random"
"""All gestures of all kinds of users, with pauses between them."""
FAST_SCENE = "fast"
"""The paper's largest motions at its largest speeds, 18 mm at 210 mm/s: the most events."""
PREPARED_S = 20.0
"""Largest sensor time of a scene."""
_VIEW_SIZES = (640, 480), (1920, 1200)
_N_VIEWS = 1_000
_LABELLED_US = range(0, round(PREPARED_S * 1e6) + 1, 40_000)
_MOST_S = "3600"
"""Sensor time for which a measured process plays at most: less than a minute."""
READY, PLAYED = "Gamepad ready", "Played "
"""The words that ``neurotouch run`` prints when the pad is ready, and at the end."""
_READER = """
import time
begun = time.process_time()
from neurotouch_hid import NeuroTouchError, open_gel
try:
    open_gel("driver:").close()
except NeuroTouchError:
    pass  # none runs, which is found out last
print(time.process_time() - begun)
"""
"""A program that reads a running driver, up to its first state."""


@dataclass(frozen=True, slots=True)
class Spread:
    """Median, 99th and 99.9th percentile. Of a rate, the value that these shares exceed."""

    median: float
    p99: float
    p999: float

    @classmethod
    def of(cls, values: NDArray[np.float64], *, rate: bool = False) -> "Spread":
        """Returns the spread of measured values."""
        ranks = (50.0, 1.0, 0.1) if rate else (50.0, 99.0, 99.9)
        return cls(*(float(v) for v in np.percentile(values, ranks)))

    def as_json(self) -> dict[str, float]:
        """Returns the same for programs."""
        return {"median": self.median, "p99": self.p99, "p99.9": self.p999}


def run_benchmark(
    method: str, progress: Callable[[str], None], *, long: bool = False
) -> dict[str, Any]:
    """Measures everything while nothing else runs.

    Args:
        method: the method of recognition.
        progress: called with a sentence at each step.
        long: measure longer, for stable figures.

    Returns:
        Of each of these median, p99 and p99.9: ``davis_decode_events_per_s`` (bytes to events),
        ``tracker_events_per_s`` (of the fast scene), ``view_640x480_ms`` and
        ``view_1920x1200_ms`` (a picture to a frame), ``rest_ms`` (per frame), ``tracker_ms``,
        ``gesture_ms``, ``profile_ms`` and ``advance_ms`` (all together, per slice of 10 ms). And
        ``tracker_ratio`` (how much longer it takes to look for the nearest marker among all),
        ``events_per_s`` of the scene of the slices, ``realtime_factor`` of a recording
        played as fast as possible, ``startup_s`` (``help_cpu``: processor
        time of ``neurotouch --help``; ``reader_cpu``: of importing and opening ``driver:``, the
        best of several; ``pad``: from the start of ``run`` to the pad) and
        ``rss_mb``, the most memory that playing it took; ``evaluate_factor``, of recordings on
        all cores; and ``live``, see ``run_live_benchmark``.
    """
    options = replace(REFERENCE, source=f"sim:{SCENE}", method=method)
    progress(f"Simulating {PREPARED_S:.0f} s of gestures")
    packets = _simulate(SCENE)
    fast = _simulate(FAST_SCENE)
    Driver(options).compile()
    gc.collect()
    progress("Measuring the stages")
    with freeze_gc():  # as ``run`` does it
        result: dict[str, Any] = {
            "davis_decode_events_per_s": Spread.of(measure_decoding(), rate=True).as_json(),
            **_measure_views(),
            **_measure_tracker(fast),
            **_measure_stages(packets, options),
        }
    progress("Measuring the whole pipeline")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bench.aedat4"
        with RecordingWriter(path) as writer:
            for packet in packets:
                writer.write(packet)
        result |= _measure_whole(path, method)
        progress("Measuring the evaluation")
        result["evaluate_factor"] = _measure_evaluation(path, options)
    progress("Measuring the start")
    result["startup_s"] = _measure_start(method)
    result["live"] = run_live_benchmark(method, progress, long=long)
    return result


def _simulate(scene: str) -> list[EventPacket]:
    packets = []
    with open_source(f"sim:{scene}", speed="max") as source:
        for packet in source:
            packets.append(packet)
            if packet.t_end_us >= PREPARED_S * 1e6:
                break
    return packets


def _measure_views() -> dict[str, Any]:
    """Returns the time in which a sensor's picture becomes the canonical one, lens included."""
    chance = np.random.default_rng(0)
    out = np.empty((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), np.uint8)
    result = {}
    for width, height in _VIEW_SIZES:
        scale = SENSOR_HEIGHT_PX / height
        table = ViewTable(View(width, height, (width / 2, height / 2), scale, lens=-0.1))
        pixels = chance.integers(0, 256, (height, width)).astype(np.uint8)
        took_ms = []
        for _ in range(_N_VIEWS + 1):
            begun = time.perf_counter()
            table.draw(pixels, out)
            took_ms.append((time.perf_counter() - begun) * 1e3)
        # The first one may have been compiled.
        result[f"view_{width}x{height}_ms"] = Spread.of(np.array(took_ms[1:])).as_json()
    return result


def _measure_tracker(packets: list[EventPacket]) -> dict[str, Any]:
    """Returns events a second through the tracker, its checks and frames included.

    ``tracker_ratio``: how much longer it takes to look for the nearest marker among all.
    """
    rest = RestDetector()
    trackers = MarkerTracker(), MarkerTracker(TrackerConfig(search="all"))
    took_s: list[list[float]] = []
    n_events = []
    for packet in packets:
        answers = [rest.update(frame) for frame in packet.frames]
        each = []
        for tracker in trackers:
            if answers and answers[-1] is not None:
                tracker.anchor(answers[-1])
            begun = time.perf_counter()
            tracker.update(packet)
            each.append(time.perf_counter() - begun)
        if len(packet.events) >= 2_000:  # a slice with little in it measures the call, not the loop
            took_s.append(each)
            n_events.append(len(packet.events))
    ours, full = np.array(took_s[1:]).T  # the first one may have been compiled
    rate = Spread.of(np.array(n_events[1:]) / ours, rate=True)
    return {"tracker_events_per_s": rate.as_json(), "tracker_ratio": float(np.median(full / ours))}


def _measure_stages(packets: list[EventPacket], options: DriverOptions) -> dict[str, Any]:
    """Returns the times of each stage alone, on the output of the one before, then of all."""
    took_ms: dict[str, list[float]] = {}

    def measure(stage: str, call: Callable[[Any], Any], argument: object) -> Any:
        begun = time.perf_counter()
        result = call(argument)
        took_ms.setdefault(stage, []).append((time.perf_counter() - begun) * 1e3)
        return result

    rest, tracker = RestDetector(), MarkerTracker()
    recognizer = GestureRecognizer(GestureConfig(method=options.method))
    mapping = Mapping(load_profile("default"))
    for packet in packets:
        answers = [measure("rest", rest.update, frame) for frame in packet.frames]
        if answers and answers[-1] is not None:
            tracker.anchor(answers[-1])
        markers = measure("tracker", tracker.update, packet)
        measure("profile", mapping.update, measure("gesture", recognizer.update, markers))
    with Driver(options) as driver:
        for packet in packets:
            measure("advance", driver.pipeline.advance, packet)
    spreads = {f"{stage}_ms": Spread.of(np.array(ms)).as_json() for stage, ms in took_ms.items()}
    return {**spreads, "events_per_s": sum(len(packet.events) for packet in packets) / PREPARED_S}


def _measure_whole(path: Path, method: str) -> dict[str, float]:
    """Plays a recording in a separate process; returns its pace without the start, and memory."""
    with _run(f"file:{path}", method) as process:  # compiles the kernels that only a file needs
        _reap(process)
    with _run(f"file:{path}", method) as process:
        _wait_for(READY, process)
        ready = time.perf_counter()
        _wait_for(PLAYED, process)
        took_s = time.perf_counter() - ready
        rss_mb = _read_peak_mb(process.pid)  # it still has to tidy up
        _reap(process)
    return {"realtime_factor": PREPARED_S / took_s, "rss_mb": rss_mb}


def _measure_evaluation(path: Path, options: DriverOptions) -> float:
    """Returns sensor time over host time, with one recording per core at a time."""
    paths = []
    for k in range(os.cpu_count() or 1):
        paths.append(path.with_stem(f"{path.stem}{k}"))
        paths[-1].hardlink_to(path)
        nothing = [Truth(t, GestureKind.NONE, np.zeros((0, 2)), 0.0) for t in _LABELLED_US]
        write_labels(labels_path(paths[-1]), nothing)
    played = evaluate_files(paths, options, jobs=len(paths)).files.values()
    return sum(each.tally.sensor_s / each.tally.host_s for each in played)


def _read_peak_mb(pid: int) -> float:
    """Returns the most memory a process had so far, 0 once it has ended.

    ``ru_maxrss`` would not do: it starts with the memory of the parent process.
    """
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmHWM"):
            return int(line.split()[1]) / 1024
    return 0.0


def _measure_start(method: str) -> dict[str, float]:
    help_cpu, reader_cpu, pad = [], [], []
    for _ in range(5):
        reader_cpu.append(_measure_reader())
        with _start("--help") as process:
            usage = _reap(process)
        help_cpu.append(usage.ru_utime + usage.ru_stime)
        begun = time.perf_counter()
        with _run("sim:rest", method) as process:
            _wait_for(READY, process)
            pad.append(time.perf_counter() - begun)
            process.terminate()
            _reap(process)
    return {
        "help_cpu": float(np.median(help_cpu)),
        "reader_cpu": min(reader_cpu),
        "pad": float(np.median(pad)),
    }


def _measure_reader() -> float:
    done = subprocess.run(make_own_python(_READER), capture_output=True, text=True, check=True)  # noqa: S603  # ours
    return float(done.stdout)


def _run(source: str, method: str) -> AbstractContextManager[subprocess.Popen[str]]:
    # It ends by itself if nobody can end it any more.
    options = ["--speed", "max", "--device", "memory", "--method", method, "--seconds", _MOST_S]
    return _start("run", "--show", "nothing", "--source", source, *options)


@contextmanager
def _start(*arguments: str) -> Iterator[subprocess.Popen[str]]:
    """Starts a process of ours, which does not outlast the block."""
    command = make_own_command(*arguments)
    # With its modules compiled, as installing does it: it is the warm start that counts.
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    with subprocess.Popen(  # noqa: S603  # our own command
        command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as process:
        try:
            yield process
        finally:
            process.kill()  # nothing, if it has been waited for


def _wait_for(words: str, process: subprocess.Popen[str]) -> None:
    for line in process.stderr or ():
        if line.startswith(words):
            return


def _reap(process: subprocess.Popen[str]) -> resource.struct_rusage:
    """Waits for the end of a process and returns its use of resources.

    Raises:
        NeuroTouchError: the process failed, so its figures have no meaning.
    """
    said = "".join(process.stderr or ())
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise NeuroTouchError(f"A measured process failed: {said.strip().rstrip('.')}.")
    return usage
