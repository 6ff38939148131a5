"""Plays labelled recordings through the pipeline and counts, on as many cores as wanted."""

import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from functools import reduce
from itertools import islice
from operator import add
from pathlib import Path
from typing import Any, Final

from neurotouch_hid.driver import REFERENCE, DriverOptions
from neurotouch_hid.errors import NeuroTouchError, RecordingError
from neurotouch_hid.evaluation.accuracy.comparison import Comparison, map_truth
from neurotouch_hid.evaluation.accuracy.label_statistics import LabelStatistics
from neurotouch_hid.evaluation.accuracy.label_track import LabelTrack
from neurotouch_hid.evaluation.accuracy.metrics import summarise
from neurotouch_hid.evaluation.accuracy.moments import WorstMoment
from neurotouch_hid.evaluation.accuracy.origin import Origin
from neurotouch_hid.evaluation.accuracy.tally import Tally
from neurotouch_hid.gel_sentences import require_gel
from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.messages import Truth
from neurotouch_hid.process.own_pool import open_pool
from neurotouch_hid.recording import Clip, check_labelled, labels_path, read_labels
from neurotouch_hid.source import PictureSource
from neurotouch_hid.source.view import View
from neurotouch_hid.vocabulary import is_clip

_STEPS_AT_ONCE: Final = 16
"""So many steps are compared one right after the other: the code and the data of the comparison
are still in the processor's caches then. One by one, between two steps, each takes three times as
long."""
_MODULES: Final = (
    __name__,
    "neurotouch_hid.driver.driver",
    "neurotouch_hid.gesture.elastic",
    "neurotouch_hid.source.replay",
)
"""What each process needs that plays recordings."""


@dataclass(frozen=True, slots=True, eq=False)
class Played:
    """Results of one recording.

    Attributes:
        tally: the counts.
        worst: its worst moments, the worst first.
        labels: statistics of its labels.
    """

    tally: Tally
    worst: list[WorstMoment]
    labels: LabelStatistics


@dataclass(frozen=True, slots=True, eq=False)
class Evaluation:
    """Results of ``evaluate_files``.

    Attributes:
        files: each recording by its name: the file's name without its ending, or the whole path
            where two share one.
    """

    files: dict[str, Played]

    def total(self) -> Tally:
        """Returns the tally of all recordings together."""
        return reduce(add, (played.tally for played in self.files.values()), Tally())

    def report(self) -> dict[str, Any]:
        """Returns the figures of all files together and, under ``files``, of each.

        Ready for JSON.
        """
        each = {name: summarise(played.tally) for name, played in self.files.items()}
        return {**summarise(self.total()), "files": each}


def combine_reports(
    reports: Mapping[str, dict[str, Any]], origin: Origin | None = None
) -> dict[str, Any]:
    """Returns the reports of one or more methods as one, ready for JSON.

    A single report stays as it is. Of several, the first is at the top level, and each, including
    the first, is under ``methods`` by its method. ``origin`` says where the figures come from.
    """
    report = next(iter(reports.values()))
    if len(reports) > 1:
        report = {**report, "methods": dict(reports)}
    return report if origin is None else {**report, "origin": origin.as_json()}


def evaluate_files(
    paths: Sequence[Path],
    options: DriverOptions = REFERENCE,
    *,
    jobs: int = 1,
    progress: Callable[[Path], None] | None = None,
    announce: Callable[[str], object] = str,  # says nothing
) -> Evaluation:
    """Plays every recording as fast as possible and compares it with the labels beside it.

    Args:
        paths: AEDAT4 recordings or video clips, each with its ``NAME.labels.csv``.
        options: method and rate, by default the paper's; each path replaces its source.
        jobs: number of recordings at a time, each in a process of its own.
        progress: called with each path when it is done.
        announce: is told when loading takes long, as when kernels are compiled; called in one of
            the processes.

    Raises:
        RecordingError: a recording or its labels cannot be read, or no label belongs to a moment
            of it; all labels are read first.
        GelNotFoundError: no frame of a recording shows the gel.
        NeuroTouchError: a process was killed.
    """
    check_labelled(paths)
    for path in paths:
        _read_labels(path)
    stems = Counter(path.stem for path in paths)
    finished = {}
    for path, played in _play_all(paths, options, min(jobs, len(paths)), announce):
        finished[path] = played
        if progress is not None:
            progress(path)
    return Evaluation(
        {path.stem if stems[path.stem] == 1 else str(path): finished[path] for path in paths}
    )


def _play_all(
    paths: Sequence[Path], options: DriverOptions, jobs: int, announce: Callable[[str], object]
) -> Iterator[tuple[Path, Played]]:
    if jobs <= 1:
        _load(options, announce)
        yield from ((path, evaluate_file(path, options)) for path in paths)
        return
    try:
        # The longest first: one that begins last would leave the other cores idle.
        by_size = sorted(paths, key=lambda path: path.stat().st_size, reverse=True)
        with open_pool(jobs, _MODULES) as pool:
            pool.submit(_load, options, announce)  # they all load now, and one of them tells
            futures = {pool.submit(evaluate_file, path, options): path for path in by_size}
            yield from ((futures[done], done.result()) for done in as_completed(futures))
    except BrokenProcessPool as error:
        raise NeuroTouchError(
            "Another program ended a process of the evaluation.",
            hint="Too little memory? Play fewer recordings at once.",
        ) from error


def _load(options: DriverOptions, announce: Callable[[str], object]) -> None:
    """Loads what every recording needs; ``announce`` is told when that takes long."""
    from neurotouch_hid.driver.chosen import NOTHING  # noqa: PLC0415
    from neurotouch_hid.driver.kernel_loading import load_kernels  # noqa: PLC0415

    load_kernels(options, NOTHING.profile, PAPER_GEL, announce)


def evaluate_file(path: Path, options: DriverOptions = REFERENCE) -> Played:
    """Returns the results of one recording; see ``evaluate_files``."""
    from neurotouch_hid.driver import Driver  # noqa: PLC0415  # only a process that plays needs it

    labels = _read_labels(path)
    with Driver(replace(options, source=f"file:{path}"), pads=False) as driver:
        # Whether it has pictures is asked once: for a protocol Python compares every name.
        source = driver.source if isinstance(driver.source, PictureSource) else None

        def find_view() -> View | None:
            return None if source is None else source.view

        comparison = Comparison(LabelTrack(labels))
        begun = time.perf_counter()
        span_us: tuple[int, int] | None = None
        steps = ((step, find_view()) for step in driver.steps())
        while some := tuple(islice(steps, _STEPS_AT_ONCE)):
            for step, view in some:
                comparison(step, view)
            begin_us = some[0][0].packet.t_begin_us if span_us is None else span_us[0]
            span_us = begin_us, some[-1][0].packet.t_end_us
        comparison.tally.host_s = time.perf_counter() - begun
        require_gel(driver.pipeline.gel, f"'{path}'", is_told=driver.source.rig is not None)
        if span_us is not None and not comparison.tally.confusion.any():
            raise _refuse_times(path, labels, span_us)
        seen = [map_truth(label, find_view()) for label in labels]
    statistics = LabelStatistics.of(seen, comparison.rig, driver.gel)
    return Played(comparison.tally, comparison.worst.ranked(), statistics)


def _refuse_times(path: Path, labels: list[Truth], span_us: tuple[int, int]) -> RecordingError:
    first_us, last_us = labels[0].t_us, labels[-1].t_us
    return RecordingError(
        f"'{labels_path(path)}' labels no moment of '{path}': its labels are from {first_us} to "
        f"{last_us} µs, the recording is from {span_us[0]} to {span_us[1]} µs.",
        hint="Write timestamp_us in µs, in the time of this recording, in two rows at least.",
    )


def _read_labels(path: Path) -> list[Truth]:
    """Returns the labels beside a recording; those of a clip are pixels of its own pictures."""
    return read_labels(labels_path(path), Clip(path).size_px if is_clip(path) else None)
