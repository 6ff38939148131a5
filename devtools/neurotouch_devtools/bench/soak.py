"""Measures memory over hours of play, as fast as possible."""

import os
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from neurotouch_hid.closing import Closing
from neurotouch_hid.driver import REFERENCE, Driver, DriverOptions
from neurotouch_hid.evaluation.speed.workload import TOUR_US, load_scene
from neurotouch_hid.events import shift_packet
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import EventPacket, Step
from neurotouch_hid.process.gc_freeze import freeze_gc
from neurotouch_hid.process.own_pool import open_pool
from neurotouch_hid.recording import RecordingWriter
from neurotouch_hid.source import open_source

SLICE_US: Final = 10_000
WARM_SHARE: Final = 0.2
"""Share of the run in which caches and allocators fill up; only growth after it shows a leak."""

_PAGE_MB: Final = os.sysconf("SC_PAGE_SIZE") / 2**20


def measure_soak(
    method: str,
    minutes: float,
    progress: Callable[[str], None],
    length_us: int = TOUR_US,
) -> dict[str, Any]:
    """Repeats all gestures, and measures the memory of the process every minute of sensor time.

    The gestures come from a recording that another process has made, so that this process is only a
    driver. The other process also compiles the kernels, which takes 0.3 GB.

    Args:
        method: the recogniser.
        minutes: sensor time.
        progress: called after each minute.
        length_us: length of the recording, which repeats.

    Returns:
        ``minutes``; ``rss_mb``, resident memory after each of them; ``kb_per_hour``, its growth
        after the first fifth, by least squares; and ``realtime_factor``.
    """
    options = replace(REFERENCE, method=method)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "soak.aedat4"
        with open_pool(1) as pool:
            pool.submit(_prepare, path, length_us, options).result()
        scale = Scale(progress)
        with (
            Driver(options, make_source=lambda: RepeatedSource(path, minutes)) as driver,
            freeze_gc(),
        ):
            stats = driver.run([scale])
    return {
        "minutes": minutes,
        "rss_mb": scale.rss_mb,
        "kb_per_hour": measure_growth(scale.rss_mb),
        "realtime_factor": stats.sensor_s / stats.host_s,
    }


def _prepare(path: Path, length_us: int, options: DriverOptions) -> None:
    Driver(replace(options, source="sim:tour")).compile()
    with RecordingWriter(path) as writer:
        for packet in load_scene("tour", SLICE_US, length_us).packets:
            writer.write(packet)


@dataclass
class RepeatedSource(Closing):
    """A source that repeats a recording; the gel is at rest at both ends of the recording.

    Args:
        path: the recording.
        minutes: sensor time.
    """

    path: Path
    minutes: float
    name = "repeat"
    rig: Rig | None = None
    is_live = False
    is_simulated = False

    def __iter__(self) -> Iterator[EventPacket]:
        now_us, end_us = 0, round(self.minutes * 60e6)
        while now_us < end_us:
            with open_source(f"file:{self.path}", slice_us=SLICE_US, speed="max") as source:
                for packet in source:
                    yield shift_packet(packet, now_us - packet.t_begin_us)
                    now_us += SLICE_US

    def close(self) -> None:
        """Does nothing: nothing is open between two repetitions."""


class Scale:
    """A tap that measures the process's memory after every minute of sensor time.

    Args:
        progress: called with each result in words.
        weigh_mb: returns the resident memory.
    """

    def __init__(
        self, progress: Callable[[str], None], weigh_mb: Callable[[], float] | None = None
    ) -> None:
        self.rss_mb: list[float] = []
        self._progress, self._weigh_mb = progress, weigh_mb or _weigh_mb
        self._begin_us: int | None = None

    def __call__(self, step: Step) -> None:
        """Measures when a minute is over."""
        if self._begin_us is None:
            self._begin_us = step.packet.t_begin_us
        if step.packet.t_end_us - self._begin_us >= (len(self.rss_mb) + 1) * 60_000_000:
            self.rss_mb.append(self._weigh_mb())
            self._progress(f"{len(self.rss_mb)} min: {self.rss_mb[-1]:.1f} MB")


def measure_growth(rss_mb: list[float]) -> float:
    """Returns growth in kB an hour, from a measurement every minute.

    With fewer than three measurements after the start it returns 0.
    """
    settled = rss_mb[int(WARM_SHARE * len(rss_mb)) :]
    if len(settled) < 3:  # two points are no trend
        return 0.0
    return float(np.polyfit(np.arange(len(settled)), settled, 1)[0]) * 60.0 * 1024.0


def _weigh_mb() -> float:
    return int(Path("/proc/self/statm").read_text().split()[1]) * _PAGE_MB
