"""Plays one recording of the matrix through the pipeline and says what came out."""

import json
import math
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from neurotouch_hid.doctor.gel import GelView
from neurotouch_hid.driver import REFERENCE, Driver
from neurotouch_hid.errors import GelNotFoundError
from neurotouch_hid.evaluation.accuracy import summarise
from neurotouch_hid.evaluation.accuracy.comparison import Comparison
from neurotouch_hid.evaluation.accuracy.label_track import LabelTrack
from neurotouch_hid.messages import GestureKind, Step
from neurotouch_hid.partial_file import remove_left
from neurotouch_hid.recording import RecordingWriter, labels_path, read_labels, write_labels
from tests.room.bound import find_bound
from tests.room.matrix import Condition, simulate


def measure(
    folder: Path, condition: Condition, seed: int, made_by: str, judged_by: str
) -> dict[str, Any]:
    """Returns the result of one recording, which is made, played or remembered."""
    name = "".join(c if c.isalnum() or c in "-.=+" else "_" for c in condition.name)
    recording = folder / made_by / f"{name}-{seed}.aedat4"
    result = folder / judged_by / f"{name}-{seed}.json"
    if result.exists():
        known: dict[str, Any] = json.loads(result.read_text())
        return known
    for path in (recording, result):
        path.parent.mkdir(parents=True, exist_ok=True)
    remove_left(recording.parent)
    record(condition, seed, recording)
    found = judge(recording)
    result.with_suffix(".part").write_text(json.dumps(found))
    result.with_suffix(".part").rename(result)
    return found


def record(condition: Condition, seed: int, path: Path) -> None:
    """Writes the recording of a condition, its labels and their bound; a finished one is kept."""
    if path.exists() and _bound_path(path).exists():
        return
    truths, slices = [], []
    with simulate(condition, seed) as simulator, RecordingWriter(path) as writer:
        for packet in simulator:
            writer.write(packet)
            truths += [simulator.truth(t_us) for t_us in simulator.find_labelled_times(packet)]
            slices.append(simulator.truth(packet.t_end_us))
        write_labels(labels_path(path), truths)
    _bound_path(path).write_text(json.dumps(find_bound(LabelTrack(truths), slices)))


def _bound_path(recording: Path) -> Path:
    return recording.with_suffix(".bound.json")


def judge(path: Path) -> dict[str, Any]:
    """Returns the figures of one recording, ready for JSON."""
    labels = LabelTrack(read_labels(labels_path(path)))
    comparison, watch = Comparison(labels), _Watch(labels)
    said = []
    with Driver(replace(REFERENCE, source=f"file:{path}")) as driver:
        try:
            driver.run([comparison, watch])
        except GelNotFoundError as error:
            said.append(f"run: “{error}”")
    found = summarise(comparison.tally)
    return {
        **watch.summarise(),
        **json.loads(_bound_path(path).read_text()),
        "type": found["gesture_accuracy"],
        "count": found["count_accuracy"],
        "distance_mm": found["distance_mm"],
        "intensity_mm": found["intensity_mae_mm"],
        "rest_f1": found["rest_f1"],
        "false_gestures": comparison.tally.timing.false_gestures,
        "events_per_s": comparison.tally.events / max(comparison.tally.sensor_s, 1e-9),
        "says": said + _ask_doctor(path),
    }


class _Watch:
    """Notes what ``evaluate`` does not: when the gel is found, how much of it is tracked."""

    def __init__(self, labels: LabelTrack) -> None:
        self._labels = labels
        self._begin_us: int | None = None
        self._found_us: int | None = None
        self._tracked = list[int]()
        self._kinds: list[tuple[GestureKind, Counter[GestureKind]]] = []
        self._end = "no data"

    def __call__(self, step: Step) -> None:
        if self._begin_us is None:
            self._begin_us = step.packet.t_begin_us
        self._tracked.append(int(step.markers.valid.sum()))
        if self._found_us is None and np.isfinite(step.markers.rest_px).any():
            self._found_us = step.packet.t_end_us
        truth = self._labels.at(step.gesture.t_us)
        if truth is not None:
            if not self._kinds or self._kinds[-1][0] is not truth.kind:
                self._kinds.append((truth.kind, Counter()))
            self._kinds[-1][1][step.gesture.kind] += 1
        neutral = "neutral" if step.pad.is_neutral else "not neutral"
        kind = step.gesture.kind
        self._end = neutral if kind is GestureKind.NONE else f"pad {neutral}, {kind.label}"

    def summarise(self) -> dict[str, Any]:
        """Returns its figures. A gesture is right if its type is, most of the time."""
        done = [(kind, seen) for kind, seen in self._kinds if kind is not GestureKind.NONE]
        right = sum(seen.most_common(1)[0][0] is kind for kind, seen in done)
        begin_us, found_us = self._begin_us or 0, self._found_us
        tracked = sorted(self._tracked) or [0]
        return {
            "found_s": None if found_us is None else (found_us - begin_us) / 1e6,
            "tracked": tracked[len(tracked) // 2],
            "tracked_5": tracked[math.floor(0.05 * len(tracked))],
            "right": right,
            "gestures": len(done),
            "end": self._end,
        }


def _ask_doctor(path: Path) -> list[str]:
    """Returns what the doctor says about the recording, if it is not that all is well."""
    view = GelView(path.with_suffix(".png"), f"file:{path}")
    findings = (view.check_stream(), view.check_markers(), view.check_rest())
    path.with_suffix(".png").unlink(missing_ok=True)
    return [
        f"doctor: “{finding.status} {_without_place(finding.sentence, path)}”"
        for finding in findings
        if finding.status not in ("OK", "SKIPPED")
    ]


def _without_place(sentence: str, path: Path) -> str:
    sentence = sentence.replace(f"file:{path}: ", "")
    return sentence.partition("; the picture with boxes")[0]
