"""Plays labelled recordings through the line and counts, on as many cores as wanted."""

import signal
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import reduce
from multiprocessing import active_children, get_context
from operator import add
from pathlib import Path
from typing import Any

from neurotouch_hid.device import MemoryDevice
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.evaluation.accuracy.comparison import Comparison
from neurotouch_hid.evaluation.accuracy.labels import LabelTrack
from neurotouch_hid.evaluation.accuracy.metrics import summarise
from neurotouch_hid.evaluation.accuracy.moments import WorstMoment
from neurotouch_hid.evaluation.accuracy.statistics import LabelStatistics
from neurotouch_hid.evaluation.accuracy.tally import Tally
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.profile import load_profile
from neurotouch_hid.recording import labels_path, read_labels
from neurotouch_hid.runtime import Pipeline, run_pipeline, warm_up
from neurotouch_hid.source import open_source


@dataclass(frozen=True, slots=True, eq=False)
class Played:
    """What came of one recording.

    Attributes:
        tally: what was counted.
        worst: its worst moments, the worst first.
        labels: what its labels are like.
    """

    tally: Tally
    worst: list[WorstMoment]
    labels: LabelStatistics


@dataclass(frozen=True, slots=True, eq=False)
class Evaluation:
    """What ``evaluate_files`` found.

    Attributes:
        files: each recording by its name: the file's name without ``.aedat4``, or the whole path
            where two share one.
    """

    files: dict[str, Played]

    def total(self) -> Tally:
        """The tally of all recordings together."""
        return reduce(add, (played.tally for played in self.files.values()), Tally())

    def report(self) -> dict[str, Any]:
        """The figures of all files together and, under ``files``, of each; ready for JSON."""
        each = {name: summarise(played.tally) for name, played in self.files.items()}
        return {**summarise(self.total()), "files": each}


def combine_reports(reports: Mapping[str, dict[str, Any]]) -> dict[str, Any]:
    """The reports of one or more methods as one, ready for JSON.

    One report stays as it is. Of several, the first lies at the top, and each, the first included,
    under ``methods`` by its method.
    """
    first = next(iter(reports.values()))
    return first if len(reports) == 1 else {**first, "methods": dict(reports)}


def evaluate_files(
    paths: Sequence[Path],
    config: GestureConfig,
    *,
    slice_us: int | None = None,
    jobs: int = 1,
    progress: Callable[[Path], None] | None = None,
) -> Evaluation:
    """Plays every recording as fast as possible and compares it with the labels beside it.

    Args:
        paths: AEDAT4 recordings, each with its ``NAME.labels.csv``.
        config: how gestures are recognised.
        slice_us: length of a slice; the paper's without.
        jobs: how many recordings at once, each in a process of its own.
        progress: called with each path when it is done.

    Raises:
        RecordingError: a recording or its labels cannot be read; all labels are read first.
        GelNotFoundError: no frame of a recording shows the gel.
        NeuroTouchError: a process was killed.
    """
    for path in paths:
        read_labels(labels_path(path))
    stems = Counter(path.stem for path in paths)
    finished = {}
    for path, played in _play_all(paths, config, slice_us, min(jobs, len(paths))):
        finished[path] = played
        if progress is not None:
            progress(path)
    return Evaluation(
        {path.stem if stems[path.stem] == 1 else str(path): finished[path] for path in paths}
    )


def _play_all(
    paths: Sequence[Path], config: GestureConfig, slice_us: int | None, jobs: int
) -> Iterator[tuple[Path, Played]]:
    if jobs <= 1:
        yield from ((path, evaluate_file(path, config, slice_us)) for path in paths)
        return
    # Fresh processes: forking one that has loaded kernels and OpenCV threads is not safe.
    pool = ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=_die_silently)
    try:
        futures = {pool.submit(evaluate_file, path, config, slice_us): path for path in paths}
        yield from ((futures[done], done.result()) for done in as_completed(futures))
    except BrokenProcessPool as error:
        raise NeuroTouchError(
            "A process of the evaluation was ended from outside.",
            hint="Too little memory? Play fewer recordings at once.",
        ) from error
    finally:
        for process in active_children():  # those that still play, after an error or Ctrl-C
            process.terminate()
        pool.shutdown()


def _die_silently() -> None:
    """Ctrl-C reaches every process of a terminal; only the first one has something to say."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def evaluate_file(path: Path, config: GestureConfig, slice_us: int | None = None) -> Played:
    """What comes of one recording; see ``evaluate_files``."""
    labels = read_labels(labels_path(path))
    comparison = Comparison(LabelTrack(labels))
    profile = load_profile("default")
    warm_up(Pipeline.build(profile, config))  # compiling is no part of the speed
    with (
        open_source(f"file:{path}", slice_us=slice_us, speed="max") as source,
        MemoryDevice() as pad,
    ):
        pipeline = Pipeline.build(profile, config, rig=source.rig)
        stats = run_pipeline(source, pipeline, pad, [comparison])
    comparison.tally.host_s = stats.host_s
    statistics = LabelStatistics.of(labels, comparison.rig)
    return Played(comparison.tally, comparison.worst.ranked(), statistics)
