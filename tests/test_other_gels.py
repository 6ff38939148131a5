"""Gels with other dots than the paper's go through the whole pipeline."""

from dataclasses import replace

import numpy as np
import pytest

from neurotouch_hid.driver.gel_file import choose_gel
from neurotouch_hid.evaluation.accuracy.files import evaluate_file
from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile import load_profile
from neurotouch_hid.recording import gel_path
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source import open_source
from neurotouch_hid.source.simulator import dataset
from tests.layouts import HEX, RINGS

DARK = replace(PAPER_GEL, name="dark", light=False)
HEX_FILE = b"version: 1\nname: hex\nlayout: {kind: hex, pitch_mm: 4.65, radius_mm: 30}\n"


def play(gel, scene, seconds):
    pipeline = Pipeline.build(load_profile("default"), GestureConfig(), gel=gel)
    with open_source(scene, speed="max", gel=gel) as source:
        for packet in source:
            if packet.t_begin_us >= 1e6 * seconds:
                return
            yield pipeline.advance(packet)


@pytest.mark.parametrize("gel", [HEX, RINGS, DARK], ids=lambda gel: gel.name)
def test_a_gesture_is_recognised(gel):
    steps = list(play(gel, "sim:pinch,missing=10", 1.6))
    found = next(step.gel for step in steps if step.gel.is_found)
    first = next(step.packet.t_end_us for step in steps if step.gel.is_found)
    assert first <= 100_000
    assert len(found.missing) >= round(0.1 * gel.n_markers)
    assert all(len(step.markers.rest_px) == gel.n_markers for step in steps)
    peak = max(steps, key=lambda step: step.gesture.intensity_mm).gesture
    assert peak.kind is GestureKind.PINCH
    assert len(peak.contacts_mm) == 2
    assert peak.intensity_mm == pytest.approx(6.0, abs=0.8)


def test_a_labelled_recording_brings_its_gel(tmp_path, monkeypatch):
    monkeypatch.setattr(dataset, "KINDS", (GestureKind.PUSH,))
    file = tmp_path / "a.gel.yaml"
    file.write_bytes(HEX_FILE)
    gel = choose_gel(str(file)).gel
    (path,) = dataset.write_dataset(
        tmp_path / "set", users=1, minutes=0.05, gel=gel, gel_file=HEX_FILE
    )
    assert gel_path(path).read_bytes() == HEX_FILE
    played = evaluate_file(path)
    assert played.labels.radius_mm == 30.0
    assert played.tally.confusion.sum() > 100
    assert (np.hypot(*played.labels.contacts_mm.T) < 32.0).all()


def test_a_recording_with_the_gel_of_the_paper_has_no_file(tmp_path, monkeypatch):
    monkeypatch.setattr(dataset, "KINDS", (GestureKind.PUSH,))
    folder = tmp_path / "set"
    folder.mkdir()
    stale = folder / "user1-push.gel.yaml"
    stale.write_bytes(HEX_FILE)
    (path,) = dataset.write_dataset(folder, users=1, minutes=0.02)
    assert gel_path(path) == stale
    assert not stale.exists()
