"""Settings of the simulator that hello finds of a rig, and recordings like it."""

import math
import zipfile
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from click.testing import CliRunner

from neurotouch_hid.cli.simulate import command
from neurotouch_hid.doctor.hello.archive import make_settings
from neurotouch_hid.doctor.hello.rig_settings import (
    FILE,
    GEL_FILE,
    RigSettings,
    blur_at_usual_scale,
    load_rig,
)
from neurotouch_hid.doctor.hello.session import PROMPTS, Session
from neurotouch_hid.driver.gel_file import load_gel_file
from neurotouch_hid.driver.gel_settings import GelSettings
from neurotouch_hid.errors import NeuroTouchError, ProfileError, RecordingError
from neurotouch_hid.gel_making.plan import make_plan
from neurotouch_hid.geometry import PAPER_GEL, Rig, fit_rig
from neurotouch_hid.profile.reading import parse_settings
from neurotouch_hid.source import open_source
from neurotouch_hid.source.simulator import dataset
from neurotouch_hid.source.simulator.config import SimulatorConfig
from neurotouch_hid.source.simulator.script import sequence
from neurotouch_hid.source.simulator.strokes import push
from neurotouch_hid.tracker import BlobFinder
from neurotouch_hid.tracker.lattice import LatticeFinder
from tests.doctor.attendant import play

_REST_US, _GAP_US = 6_600_000, 1_300_000
_MISSING = (5, 60, 120)


def plant() -> SimulatorConfig:
    """A rig that differs from the usual one in all that can be measured."""
    usual = SimulatorConfig()
    return replace(
        usual,
        gel=replace(usual.gel, residue=0.03, missing=_MISSING),
        camera=replace(usual.camera, rig=Rig((165.0, 136.0), 2.2, 0.3)),
        light=replace(usual.light, white_dn=160.0, black_dn=20.0),
        sensor=replace(
            usual.sensor,
            blur_px=blur_at_usual_scale(1.2, 2.2),
            shot_hz=3.0,
            n_hot=60,
            hot_hz=150.0,
            read_noise_dn=3.0,
            frame_us=25_000,
            exposure_us=5_000,
        ),
    )


_NUISANCES = {"readout": 20.0}


def meet(config: SimulatorConfig, nuisances: dict[str, float]) -> Session:
    """Lets a scripted person rest and push a simulated rig, as hello asks for."""
    script = sequence("hello", push(0.0, 7.0), rest_us=_REST_US, gap_us=_GAP_US)
    done_us = [500_000, _REST_US - 100_000, script.strokes[0].end_us + _GAP_US - 100_000]
    session = Session(make_plan(load_gel_file(None).settings), "sim", PROMPTS[:3])
    for step in play(script, config, nuisances):
        session.take(step)
        if done_us and step.packet.t_end_us >= done_us[0]:
            done_us.pop(0)
            session.next()
    session.finish()
    return session


@cache
def meet_planted() -> tuple[Session, RigSettings]:
    session = meet(plant(), _NUISANCES)
    text = make_settings(session, None, is_simulated=True)[FILE]
    return session, parse_settings(text.encode(), FILE, RigSettings)


def test_what_was_planted_is_written_down():
    settings = meet_planted()[1]
    assert settings.simulated
    assert settings.camera == "events"
    planted = plant()
    assert (settings.centre_x_px, settings.centre_y_px) == pytest.approx((165.0, 136.0), abs=0.3)
    assert settings.px_per_mm == pytest.approx(2.2, rel=0.01)
    assert settings.turn_deg == pytest.approx(17.2, abs=0.3)
    assert settings.blur_px == pytest.approx(1.2, abs=0.1)
    assert settings.white_dn == pytest.approx(planted.light.white_dn, rel=0.07)
    assert settings.black_dn == pytest.approx(planted.light.black_dn, rel=0.07)
    assert settings.read_noise_dn == pytest.approx(3.0, rel=0.07)
    assert (settings.frame_us, settings.exposure_us) == (25_000, 5_000)
    assert settings.shot_hz == pytest.approx(3.0, rel=0.07)
    assert settings.hot_pixels == 60
    assert settings.hot_hz == pytest.approx(150.0, rel=0.1)
    assert settings.readout_times == pytest.approx(20.0, rel=0.15)
    assert settings.kept_share == pytest.approx(0.03, abs=0.01)
    assert settings.missing_dots == [each + 1 for each in _MISSING]


def test_rig_like_it_is_measured_alike():
    session, settings = meet_planted()
    there = session.list_figures()
    here = meet(settings.configure(PAPER_GEL), settings.list_nuisances()).list_figures()
    near = {
        "noise_hz_per_px": 0.05,
        "hot_pixels": 0.05,
        "hot_hz": 0.1,
        "readout_ratio": 0.1,
        "frame_noise_dn": 0.05,
        "contrast_dn": 0.07,
        "dot_dn": 0.05,
        "peak_dn": 0.07,
        "ground_dn": 0.05,
        "fitted_px_per_mm": 0.005,
        "fitted_turn_deg": 0.01,
        "centre_x_px": 0.002,
        "centre_y_px": 0.002,
        "frame_period_us": 0.0,
        "exposure_us": 0.0,
        "dots_missing": 0.0,
        "kept_share": 0.3,
    }
    differing = {
        name: (there[name], here[name])
        for name, share in near.items()
        if here[name] != pytest.approx(there[name], rel=share)
    }
    assert differing == {}
    assert here["blur_px"] == pytest.approx(there["blur_px"], abs=0.1)


def test_each_stroke_is_compared_with_what_it_leaves_itself():
    """Before, the largest motion of any stroke since the gel was still was taken instead."""
    usual = SimulatorConfig()
    config = replace(usual, gel=replace(usual.gel, residue=0.05))
    strokes = (push(0.0, 9.0), push(0.5 * math.pi, 6.0), push(math.pi, 6.0))
    script = sequence("three", *strokes, rest_us=2_500_000, gap_us=200_000)
    script = replace(script, duration_us=script.duration_us + 1_100_000)
    session = Session(make_plan(load_gel_file(None).settings), "sim", guided=False)
    for step in play(script, config):
        session.take(step)
    assert session.list_figures()["kept_share"] == pytest.approx(0.05, abs=0.015)


def test_camera_with_events_is_one_also_without_a_rest():
    session = Session(make_plan(load_gel_file(None).settings), "sim", guided=False)
    for step in play(sequence("short", push(0.0, 7.0)), SimulatorConfig()):
        session.take(step)
    text = make_settings(session, None, is_simulated=True)[FILE]
    assert "camera: events" in text
    assert "shot_hz" not in text


def write_zip(path: Path, parts: dict[str, str]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in parts.items():
            archive.writestr(name, content)
    return path


def run(*words: str | Path):
    return CliRunner().invoke(command, [str(word) for word in words])


@pytest.fixture
def short_rest(monkeypatch):
    monkeypatch.setattr(dataset, "LONG_REST_US", 600_000)


@pytest.mark.usefixtures("short_rest")
def test_recordings_are_like_the_file(tmp_path):
    text = RigSettings(px_per_mm=1.9, turn_deg=17.2, frame_us=20_000, exposure_us=5_000).format()
    path = write_zip(tmp_path / "a.hello.zip", {FILE: text})
    out = tmp_path / "set"
    result = run(out, "--like", path, "--users", "1", "--minutes", "0.1")
    assert result.exit_code == 0, result.output
    assert "Like a real rig: 4 of 17 settings were measured" in result.output
    recipes = dataset.read_manifest(out)
    assert len({recipe["like"] for recipe in recipes.values()}) == 1
    with open_source(str(out / "user1-push.aedat4"), speed="max") as source:
        frames = [frame for packet in source for frame in packet.frames]
    assert frames[1].t_us - frames[0].t_us == 20_000
    dots_px = BlobFinder().find(frames[-1].pixels).centroid_px
    lattice = LatticeFinder(PAPER_GEL).find(dots_px)
    rig = fit_rig(lattice.position_px)
    assert rig.px_per_mm == pytest.approx(1.9 * 1.0246, rel=0.01)
    again = run(out, "--users", "1", "--minutes", "0.1")
    assert isinstance(again.exception, RecordingError)  # another set


@pytest.mark.usefixtures("short_rest")
def test_camera_without_events_gives_clips(tmp_path):
    text = RigSettings(camera="pictures", frame_us=16_667, exposure_us=8_000).format()
    path = write_zip(tmp_path / "a.hello.zip", {FILE: text})
    result = run(tmp_path / "set", "--like", path, "--users", "1", "--minutes", "0.1")
    assert result.exit_code == 0, result.output
    assert (tmp_path / "set" / "user1-push.mkv").exists()


@pytest.mark.usefixtures("short_rest")
def test_camera_without_frames_gives_none(tmp_path):
    path = write_zip(tmp_path / "a.hello.zip", {FILE: RigSettings(camera="events-only").format()})
    result = run(tmp_path / "set", "--like", path, "--users", "1", "--minutes", "0.1")
    assert result.exit_code == 0, result.output
    with open_source(str(tmp_path / "set" / "user1-push.aedat4"), speed="max") as source:
        packets = list(source)
    assert not any(packet.frames for packet in packets)
    assert sum(len(packet.events) for packet in packets) > 100_000


def test_own_gel_goes_with_it(tmp_path):
    gel = "layout: {kind: hex, pitch_mm: 5, radius_mm: 28}\ndot_mm: 1.5\n"
    path = write_zip(tmp_path / "a.hello.zip", {FILE: "version: 1\n", GEL_FILE: gel})
    made = parse_settings(gel.encode(), "gel", GelSettings).make()
    assert load_rig(path).gel.gel.n_markers == made.n_markers


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("px_per_mm: 100", "5.7"),
        ("px_per_mm: .nan", "px_per_mm"),
        ("px_per_mm: two", "px_per_mm"),
        ("frame_us: -5", "frame_us"),
        ("version: 2", "version"),
        ("missing_dots: [0]", "missing_dots"),
        ("colour: red", "colour"),
        ("camera: webcam", "camera"),
        ("version: [", "["),
        ("", "empty"),
    ],
)
def test_wrong_settings_have_a_place(tmp_path, text, fault):
    path = write_zip(tmp_path / "a.hello.zip", {FILE: text})
    with pytest.raises(ProfileError) as caught:
        load_rig(path)
    assert f"a.hello.zip/{FILE}" in caught.value.message
    assert fault in caught.value.message
    assert caught.value.exit_code == 6


def write_twice(path: Path) -> Path:
    other = f"{FILE[:-1]}_"  # zipfile itself would warn
    write_zip(path, {FILE: "version: 1\n", other: "version: 1\n"})
    path.write_bytes(path.read_bytes().replace(other.encode(), FILE.encode()))
    return path


def write_changed(path: Path, at: int, byte: int) -> Path:
    """Writes a file with one byte changed, counted from where the directory begins."""
    write_zip(path, {FILE: "version: 1\n"})
    content = bytearray(path.read_bytes())
    content[content.index(b"PK\x01\x02") + at] = byte
    path.write_bytes(content)
    return path


def write_bytes(path: Path, content: bytes) -> Path:
    path.write_bytes(content)
    return path


def make_folder(path: Path) -> Path:
    path.mkdir()
    return path


@pytest.mark.parametrize(
    ("make", "fault"),
    [
        (lambda path: path, "No such file"),
        (make_folder, "a folder"),
        (lambda path: write_bytes(path, b""), "no zip file"),
        (lambda path: write_bytes(path, b"PK\x05\x06" + b"\xff" * 18), "no zip file"),
        (lambda path: write_zip(path, {"other.txt": "x"}), f"no {FILE} in it"),
        (lambda path: write_zip(path, {FILE: "#" * 70_000}), "larger than 64 kB"),
        (write_twice, "twice"),
        (lambda path: write_changed(path, 8, 1), "encrypted"),
        (lambda path: write_changed(path, 10, 12), "unusual way"),
        (lambda path: write_changed(path, 16, 77), "no zip file"),
        (lambda path: write_changed(path, 44, 77), "no zip file"),
    ],
)
def test_foreign_file_is_refused(tmp_path, make, fault):
    path = make(tmp_path / "a.zip")
    with pytest.raises(RecordingError) as caught:
        load_rig(path)
    assert fault in caught.value.message
    assert caught.value.exit_code == 4
    assert "neurotouch hello" in caught.value.hint


def test_any_damage_is_refused_or_read(tmp_path):
    """Whatever byte is changed, there is a rig or a sentence, and nothing else."""
    path = write_zip(tmp_path / "a.zip", {FILE: RigSettings(px_per_mm=2.0).format()})
    sound, n_refused = path.read_bytes(), 0
    for at in range(len(sound)):
        path.write_bytes(sound[:at] + bytes([sound[at] ^ 0xFF]) + sound[at + 1 :])
        try:
            load_rig(path)
        except NeuroTouchError:
            n_refused += 1
    assert n_refused > 0.5 * len(sound)
