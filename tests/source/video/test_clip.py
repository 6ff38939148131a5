"""A clip is played like a recording: at any size, mirrored, cut off, in the whole pipeline."""

import os
import shutil
from itertools import pairwise

import numpy as np
import pytest

from neurotouch_hid import Driver, DriverOptions, open_gel
from neurotouch_hid.errors import RecordingError
from neurotouch_hid.evaluation.accuracy import evaluate_files
from neurotouch_hid.geometry import PAPER_GEL, fit_rig
from neurotouch_hid.recording import (
    Clip,
    ClipWriter,
    Picture,
    labels_path,
    read_labels,
    write_labels,
)
from neurotouch_hid.source import PictureSource, open_source
from neurotouch_hid.tracker import GelFinder
from neurotouch_hid.vocabulary import GestureKind
from tests.recording.clips import draw, read_by_ffmpeg, write_clip
from tests.source.video.simulated_clip import Lens, make_clip


def check_figures(report):
    """What a recording of the camera itself reaches, on the same scene."""
    assert report["gesture_accuracy"] > 0.97
    assert report["count_accuracy"] > 0.97
    assert report["intensity_mae_mm"] < 0.3
    assert report["distance_mm"] < 0.8  # labels in the video's own pixels


def test_gestures_of_a_clip_are_recognised(pushed):
    check_figures(evaluate_files([pushed]).report())


def test_a_mirrored_clip_with_a_rig_file(pushed, tmp_path):
    path = tmp_path / "flipped.mkv"
    clip = Clip(pushed)
    with ClipWriter(path) as writer:
        for p in clip:
            writer.write(Picture(p.pixels[:, ::-1], p.exposure_begin_us, p.exposure_end_us))
    width = clip.size_px[0]
    labels = read_labels(labels_path(pushed), clip.size_px)
    for label in labels:
        label.contacts_px[:, 0] = width - 1 - label.contacts_px[:, 0]
    write_labels(labels_path(path), labels)
    (tmp_path / "flipped.rig.yaml").write_text("mirrored: true\n")
    check_figures(evaluate_files([path]).report())


@pytest.mark.parametrize(
    "lens",
    [
        Lens((320, 240), 0.9, 0.1),
        Lens((480, 640), 1.7, -0.2),
        Lens((1920, 1200), 4.2, -0.1, (860.0, 620.0)),
    ],
    ids=["small", "portrait", "large"],
)
def test_every_size_shows_the_gel_in_its_place(tmp_path, lens):
    path = make_clip(tmp_path / "a.mkv", "push", lens, seconds=0.6, frame_us=40_000)
    with open_source(f"file:{path}", speed="max", finder=GelFinder()) as source:
        assert isinstance(source, PictureSource)
        frames = [frame for packet in source for frame in packet.frames]
    found = fit_rig(
        GelFinder().find(frames[1].pixels), PAPER_GEL
    )  # the first one that was confirmed
    assert found.px_per_mm == pytest.approx(2.5, rel=0.03)
    assert found.centre_px == pytest.approx((172.5, 129.5), abs=2.0)
    assert (source.view.width_px, source.view.height_px) == lens.size_px


def test_touches_of_a_clip_as_a_program_reads_them(pushed):
    with open_gel(pushed, speed="max") as gel:
        kinds = {touch.kind for touch in gel}
    assert kinds == {GestureKind.NONE.label, GestureKind.PUSH.label}


def test_slices_are_equal_and_frames_in_order(pushed):
    with open_source(str(pushed), speed="max", finder=GelFinder()) as source:
        packets = list(source)
        again = list(source)
    for before, after in pairwise(packets):
        assert before.t_end_us == after.t_begin_us
    stamps = [frame.exposure_end_us for packet in packets for frame in packet.frames]
    assert stamps == sorted(set(stamps))
    assert stamps[:2] == [0, 8_000]  # found at once, confirmed by the next one
    assert stamps == [picture.exposure_end_us for picture in Clip(pushed)]
    assert [len(packet.frames) for packet in again] == [len(packet.frames) for packet in packets]


def test_a_rig_file_that_says_more_than_mirrored_is_refused(tmp_path):
    path = write_clip(tmp_path / "a.mkv", [draw(0)], [0])
    (tmp_path / "a.rig.yaml").write_text("centre_px: [100, 100]\npx_per_mm: 2.5\n")
    with pytest.raises(RecordingError, match="only 'mirrored' applies to a video"):
        open_source(str(path))


def test_a_clip_that_is_cut_off_plays_up_to_the_break(pushed, tmp_path):
    path = tmp_path / "a.mkv"
    shutil.copy(pushed, path)
    os.truncate(path, path.stat().st_size // 2)
    packets = []
    with pytest.raises(RecordingError, match=r"(is cut off|is damaged) [0-9.]+ s after"):
        packets.extend(open_source(str(path), speed="max", finder=GelFinder()))
    assert packets[-1].t_end_us == pytest.approx(1_500_000, abs=300_000)


def test_left_out_pictures_are_told(tmp_path, caplog):
    noisy = np.random.default_rng(0).integers(0, 255, (3, 240, 320)).astype(np.uint8)
    stamps = [0, 40_000, 40_100, 80_000]
    pictures = [noisy[0], noisy[1], noisy[2], noisy[1]]
    path = write_clip(tmp_path / "a.mp4", pictures, stamps, "ffv1", "gray", strict="-2")
    n = sum(len(packet.frames) for packet in open_source(str(path), speed="max"))
    assert n == 2
    assert "1 pictures were not later than the one before" in caplog.text
    assert "1 pictures repeated the one before" in caplog.text


def test_a_real_gel_is_read_with_its_stamps(real_gel):
    clip = Clip(real_gel)
    assert clip.size_px == (320, 240)
    pictures = list(clip)
    assert [p.exposure_end_us for p in pictures] == [40_000 * k for k in range(219)]
    assert clip.n_left_out == 0
    assert all(20 < p.pixels.mean() < 235 for p in pictures)
    assert len({p.pixels.tobytes() for p in pictures}) > 200
    for given, picture in zip(read_by_ffmpeg(real_gel)[0], pictures, strict=True):
        assert (given == picture.pixels).all()


REAL_GEL = """\
version: 1
name: gelsight-mini
layout: {kind: grid, columns: 10, rows: 7, pitch_mm: 2.03}
dot_mm: 0.63
dots: dark
dome_height_mm: 0
"""


def test_a_real_gel_is_found_and_followed_to_the_end(real_gel, tmp_path):
    path = tmp_path / "real.avi"
    shutil.copy(real_gel, path)
    (tmp_path / "real.gel.yaml").write_text(REAL_GEL)
    options = DriverOptions(source=f"file:{path}", device="memory", speed="max", listens=False)
    with Driver(options) as driver:
        steps = list(driver.steps())
        view = driver.source.view
    assert steps[4].gel.is_found  # the first picture is at 0 s
    fields = [step.markers for step in steps[4:]]
    assert {len(field.valid) for field in fields} == {70}
    # One column of ten is half out of the picture while fingers push it there.
    assert min(field.valid.sum() for field in fields) >= 54
    moved = np.hypot(*(fields[-1].position_px - fields[-1].rest_px).T)
    assert np.median(moved) < 1.0  # the fingers have gone: a dot of its own, not its neighbour
    assert moved.max() < 4.0  # of 10 px to the next one
    largest = max(np.hypot(*(f.position_px - f.rest_px).T).max() for f in fields)
    assert largest > 3.0  # it was really pushed
    kinds = {step.gesture.kind for step in steps}
    assert kinds == {GestureKind.NONE, GestureKind.PUSH}  # looked at: one finger at a time
    assert all(step.gesture.kind is GestureKind.NONE for step in steps if step.gesture.t_us < 2e6)
    contacts = np.concatenate([s.gesture.contacts_px for s in steps if s.gesture.kind])
    seen = view.to_sensor(contacts)
    assert ((seen >= 0) & (seen <= (319, 239))).all()  # on the picture
