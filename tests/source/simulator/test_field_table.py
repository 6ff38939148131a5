"""Tables of displacements that move the simulated dots; one of a real gel under a real finger."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from neurotouch_hid.driver import REFERENCE, Driver
from neurotouch_hid.errors import RecordingError, SourceError
from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile.reading import load_profile
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source import check_source
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.field_table import COLUMNS, FieldTable, read_field_table

GRID_MM = np.stack(np.meshgrid(np.arange(-16, 17, 4.0), np.arange(-12, 13, 4.0)), -1).reshape(-1, 2)
HEAD = ",".join(COLUMNS)


def write(path, times_us, places_mm):
    lines = [
        f"{t},{i},{x:.4f},{y:.4f}"
        for t, row in zip(times_us, places_mm, strict=True)
        for i, (x, y) in enumerate(row)
    ]
    path.write_text("\n".join([HEAD, *lines]) + "\n")
    return path


def make_push(largest_mm=5.0, n=50):
    """A push to the right and back, over two seconds after one of rest."""
    times = np.concatenate([[0], 1_000_000 + 40_000 * np.arange(n + 1)])
    size = np.concatenate([[0.0], largest_mm * np.sin(np.pi * np.arange(n + 1) / n) ** 2])
    share = np.exp(-((np.linalg.norm(GRID_MM, axis=1) / 9.0) ** 2))
    moved = np.zeros((len(times), len(GRID_MM), 2))
    moved[:, :, 0] = size[:, None] * share
    return times, GRID_MM + moved


def test_the_dots_of_the_gel_move_as_those_of_the_table(tmp_path):
    table = read_field_table(write(tmp_path / "a.csv", *make_push()))
    weights = table.spread(PAPER_GEL.points_mm)
    moved = weights @ table.measure(2_000_000)
    far = np.linalg.norm(PAPER_GEL.points_mm, axis=1)
    inside = far < 9.0
    true = 5.0 * np.exp(-((far / 9.0) ** 2))
    assert np.abs(moved[inside, 0] - true[inside]).max() < 0.35  # a little smoothed
    assert np.abs(moved[:, 1]).max() < 0.01
    assert np.abs(moved[far > 28.0]).max() < 0.05


def test_motion_is_smooth_and_exact_at_the_times_of_the_table(tmp_path):
    times, places = make_push()
    table = read_field_table(write(tmp_path / "a.csv", times, places))
    for k in (0, 1, 20, 50):
        np.testing.assert_allclose(table.measure(int(times[k])), places[k] - GRID_MM, atol=1e-3)
    steps = np.diff([table.measure(t)[31, 0] for t in range(1_000_000, 3_000_000, 4_000)])
    assert np.abs(np.diff(steps)).max() < 0.003
    assert (table.measure(9_999_999) == table.measure(3_000_000)).all()


def test_a_table_plays_through_the_whole_pipeline(tmp_path):
    path = write(tmp_path / "push.csv", *make_push())
    check_source(f"sim:{path}")
    seen = []
    with Driver(replace(REFERENCE, source=f"sim:{path}")) as driver:
        driver.run([lambda step: seen.append(step.gesture)])
    strongest = max(seen, key=lambda gesture: gesture.intensity_mm)
    assert strongest.kind is GestureKind.PUSH
    assert strongest.translation_mm[0] == pytest.approx(4.0, abs=1.0)
    assert seen[-1].kind is GestureKind.NONE


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ":1: expected the columns time_us"),
        ("t,marker,x,y\n", ":1: expected the columns"),
        (f"{HEAD}\n", "0 times of 0 markers"),
        (f"{HEAD}\n0,0,1\n", ":2: expected 4 columns, found 3"),
        (f"{HEAD}\nsoon,0,1,1\n", ":2: column time_us: expected a whole number"),
        (f"{HEAD}\n0,0,nan,1\n", ":2: column x_mm: expected millimetres from -1000 to"),
        (f"{HEAD}\n0,0,1,1e9\n", ":2: column y_mm: expected millimetres from -1000 to 1000"),
        (f'{HEAD}\n0,0,"1,1\n', "has a quotation mark too many, or one is missing."),
        (f"{HEAD}\n0,1,1,1\n", ":2: column marker: expected 0, found 1"),
        (f"{HEAD}\n0,0,1,1\n0,0,1,1\n", ":3: column marker: expected 1, found 0"),
        (f"{HEAD}\n5,0,1,1\n4,0,1,1\n", ":3: column time_us: expected a time after 5"),
        (f"{HEAD}\n0,0,1,1\n0,1,1,1\n5,0,1,1\n6,0,1,1\n", ":5: expected marker 1"),
        (f"{HEAD}\n0,0,1,1\n5,0,1,1\n5,1,1,1\n", ":4: column marker"),
        ('x"\n', "expected the columns"),
    ],
)
def test_a_wrong_table_is_one_sentence(tmp_path, text, words):
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(RecordingError) as caught:
        read_field_table(path)
    assert words in caught.value.message


def test_a_table_that_is_not_there():
    with pytest.raises(SourceError, match=r"There is no file 'none\.csv'"):
        check_source("sim:none.csv")


def read_real() -> FieldTable:
    """The maker's own tracks of a GelSight Mini, with its pitch stretched to that of the dome."""
    folder = Path(os.environ.get("NEUROTOUCH_SHARED_DATA", "../shared/data"))
    path = folder / "gelsight-mini-tracks.csv"
    if not path.exists():
        pytest.skip(f"the real gel's tracks {path} are not here (folder: NEUROTOUCH_SHARED_DATA)")
    rows = np.loadtxt(path, delimiter=",")
    places = rows[:, 5:7].reshape(-1, 80, 2)
    rest = rows[:80, 3:5]
    pitch_px = np.median(np.diff(rest[:, 0].reshape(8, 10), axis=1))
    moved = np.concatenate([rest[None], rest[None], places]) - rest.mean(axis=0)
    times = np.concatenate([[0, 1_000_000], 1_040_000 + 40_000 * np.arange(len(places))])
    return FieldTable("real tracks", times, moved * PAPER_GEL.pitch_mm / pitch_px)


@pytest.mark.parametrize("has_frames", [True, False])
def test_a_real_finger_is_followed_and_pushes(has_frames):
    """A hand was seen to press and push with one finger; nothing says when exactly."""
    simulator = Simulator(read_real())
    pipeline = Pipeline.build(load_profile("default"), GestureConfig())
    errors, kinds = [], []
    for packet in simulator:
        is_late = packet.t_begin_us > 1_000_000
        given = packet if has_frames or not is_late else replace(packet, frames=())
        step = pipeline.advance(given)
        if is_late and packet.t_end_us % 40_000 == 0:
            true = simulator.truth(packet.t_end_us).markers_px
            errors.append(np.linalg.norm(step.markers.position_px - true, axis=1))
            moved_mm = np.linalg.norm(true - step.markers.rest_px, axis=1).max() / 2.5
            kinds.append((moved_mm, step.gesture.kind))
    strong = [kind for moved_mm, kind in kinds if moved_mm > 1.5]
    weak = [kind for moved_mm, kind in kinds if moved_mm < 0.15]
    assert len(strong) > 100
    assert np.mean([kind is GestureKind.PUSH for kind in strong]) > 0.97
    assert np.mean([kind is GestureKind.NONE for kind in weak]) > 0.97
    assert np.median(errors) < (0.2 if has_frames else 0.35)
    assert (np.array(errors[-1]) > 2.0).sum() == 0
    simulator.close()
