"""The first meeting with a camera, with a scripted person before simulated rigs."""

import csv
import io
import json
import re
import zipfile
from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from neurotouch_hid.cli.hello import command
from neurotouch_hid.doctor.hello.answers import Word, answer_all, compare
from neurotouch_hid.doctor.hello.archive import make_report, write_archive
from neurotouch_hid.doctor.hello.camera_facts import read_davis, read_opened
from neurotouch_hid.doctor.hello.session import PROMPTS, Session
from neurotouch_hid.driver.gel_file import load_gel_file
from neurotouch_hid.gel_making.plan import make_plan
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import Step
from neurotouch_hid.recording import RecordingWriter
from neurotouch_hid.source.simulator.config import SimulatorConfig
from neurotouch_hid.source.simulator.script import Script, sequence
from neurotouch_hid.source.simulator.strokes import push, twist
from neurotouch_hid.source.video.live import VideoCameraSource
from neurotouch_hid.vocabulary import SourceKind
from tests.doctor.attendant import play
from tests.source.davis.camera import ScriptedCamera
from tests.source.video.fake_camera import FakeCamera, FakeLinux

_REST_US = 6_600_000
_GAP_US = 1_300_000
_ASKED = ("light", "rest", "push_right", "twist_cw")
"""The others are made in the same way."""


def make_script() -> Script:
    return sequence("hello", push(0.0, 7.0), twist(0.5), rest_us=_REST_US, gap_us=_GAP_US)


@cache
def play_usual() -> tuple[Step, ...]:
    """What a person with the usual rig makes, simulated once."""
    return tuple(play(make_script(), SimulatorConfig()))


def meet(steps: Iterable[Step]) -> Session:
    """Lets a scripted person follow the prompts: Enter once each movement is over."""
    script = make_script()
    done_us = [500_000, _REST_US - 100_000]
    done_us += [stroke.end_us + _GAP_US - 100_000 for stroke in script.strokes]
    session = Session(
        make_plan(load_gel_file(None).settings),
        "sim",
        [prompt for prompt in PROMPTS if prompt.key in _ASKED],
    )
    for step in steps:
        session.take(step)
        if done_us and step.packet.t_end_us >= done_us[0]:
            done_us.pop(0)
            assert session.missing == "", session.prompt
            session.next()
    session.finish()
    return session


@cache
def meet_usual() -> Session:
    return meet(play_usual())


@cache
def meet_other() -> Session:
    """A rig with planted differences: more noise, turned, smaller, and a gel that keeps 3 %."""
    usual = SimulatorConfig()
    rig = Rig((172.5, 129.5), 2.0, 0.3)
    config = replace(
        usual,
        gel=replace(usual.gel, residue=0.03),
        camera=replace(usual.camera, rig=rig),
        sensor=replace(usual.sensor, shot_hz=4.0, leak_hz=0.4),
    )
    return meet(play(make_script(), config))


def find(session: Session, name: str) -> float:
    value = session.list_figures()[name]
    assert value is not None, name
    return value


def say(session: Session, name: str) -> str:
    return next(each.sentence for each in compare(session.list_figures()) if each.name == name)


def answer(session: Session, point: str, camera: dict | None = None):
    answers = answer_all(session, SourceKind.CAMERA, camera or {}, is_simulated=False)
    return next(each for each in answers if each.point == point)


def test_usual_rig_is_as_simulated():
    told = [each.sentence for each in compare(meet_usual().list_figures()) if each.here is not None]
    assert len(told) == 12
    assert [sentence for sentence in told if "as simulated" not in sentence] == []


def test_planted_differences_are_found():
    usual, other = meet_usual(), meet_other()
    assert find(other, "noise_hz_per_px") > 2.0 * find(usual, "noise_hz_per_px")
    assert find(other, "px_per_mm") == pytest.approx(2.0, rel=0.05)
    assert find(other, "rotation_deg") == pytest.approx(17.2, abs=1.0)
    assert find(other, "kept_share") == pytest.approx(0.03, abs=0.01)


def test_planted_differences_are_said():
    for name, way in (
        ("noise_hz_per_px", "more than the simulated"),
        ("px_per_mm", "less than the simulated"),
        ("rotation_deg", "more than the simulated"),
        ("kept_share", "more than the simulated"),
    ):
        assert way in say(meet_other(), name)


def test_recording_without_a_rest_says_nothing_of_the_gels_return():
    session = Session(make_plan(load_gel_file(None).settings), "file", guided=False)
    begin_us = make_script().strokes[0].start_us - 300_000
    for step in play_usual():
        if step.packet.t_begin_us >= begin_us:
            session.take(step)
    session.finish()
    assert [span.prompt.key for span in session.spans] == ["rest", "everything"]
    assert len(session.spans[1].strokes) == 2
    assert session.list_figures()["kept_share"] is None
    assert "this run does not show it" in say(session, "kept_share")


def test_recording_with_a_rest_is_measured_without_prompts():
    session = Session(make_plan(load_gel_file(None).settings), "file", guided=False)
    for step in play_usual():
        session.take(step)
    session.finish()
    assert "as simulated" in say(session, "kept_share")
    assert "as simulated" in say(session, "noise_hz_per_px")
    assert answer(session, "play").word is Word.OPEN


def test_what_cannot_be_measured_is_said():
    assert "not measurable without force" in say(meet_usual(), "stiffness")


def test_movements_are_recognised_and_directions_right():
    assert answer(meet_usual(), "play").word is Word.YES
    assert answer(meet_usual(), "mirrored").word is Word.NO


def light_up(steps: Iterable[Step]) -> Session:
    """Lets a person rest for two seconds, under some light."""
    session = make_waiting_session()
    session.next()
    for step in steps:
        session.take(step)
        if step.packet.t_end_us >= 2_000_000:
            return session
    raise AssertionError


@pytest.mark.parametrize(("lamp", "percent", "hz"), [("mains", 40.0, 100), ("pwm", 30.0, 200)])
def test_light_that_flickers_is_named(lamp, percent, hz):
    told = answer(light_up(play(make_script(), SimulatorConfig(), {lamp: percent})), "settings")
    assert told.word is Word.NO
    assert told.sentence == f"The light flickers at {hz} Hz. Use a lamp that is steady."


def test_steady_light_is_not_said_to_flicker():
    told = answer(light_up(play_usual()), "settings")
    assert "flicker" not in told.sentence
    assert "flicker" not in answer(meet_usual(), "settings").sentence


def test_every_open_question_has_an_answer():
    page = (Path(__file__).parents[2] / "docs/hardware.md").read_text()
    section = page.split("## What only a real camera can tell")[1].split("\n## ")[0]
    asked = [line.partition("`")[2].partition("`:")[0] for line in re.findall("(?m)^- .*", section)]
    answers = answer_all(meet_usual(), SourceKind.CAMERA, {}, is_simulated=False)
    assert [each.point for each in answers] == asked
    assert all(each.sentence.endswith(".") for each in answers)


def test_simulation_answers_nothing():
    answers = answer_all(meet_usual(), SourceKind.SIMULATION, {}, is_simulated=True)
    assert {each.word for each in answers} == {Word.OPEN}


def test_camera_that_says_who_it_is():
    camera = {"firmware": 6, "usb_mbit_s": 480}
    camera["registers"] = {"DVS_ORIENTATION": 4, "SYSINFO_CHIP": 5, "APS_COLOR": 1}
    assert "axes swapped" in answer(meet_usual(), "orientation", camera).sentence
    assert answer(meet_usual(), "usb2", camera).word is Word.YES
    assert answer(meet_usual(), "variant", camera).word is Word.YES


def make_waiting_session() -> Session:
    return Session(make_plan(load_gel_file(None).settings), "sim")


def test_prompt_waits_for_what_is_missing():
    session = make_waiting_session()
    assert session.missing == "The gel is not found yet."
    session.next()
    assert session.missing == "0 of 5 seconds so far."
    session.next()
    assert session.missing == "No movement was seen yet."


def test_rest_ends_while_the_driver_has_lost_the_dots():
    session = make_waiting_session()
    session.next()
    for step in play_usual():
        if step.packet.t_end_us > 4_000_000:
            break
        session.take(step)
    seconds = session.list_figures()["seconds"]
    assert seconds > 2.0
    unknown = step.markers.rest_px * np.nan
    session.take(replace(step, markers=replace(step.markers, rest_px=unknown)))
    assert session.list_figures()["seconds"] == seconds
    session.next()
    assert session.rig.px_per_mm == pytest.approx(2.5, rel=0.05)


def test_touch_begins_the_rest_again():
    session = make_waiting_session()
    session.next()
    begin_us = make_script().strokes[0].start_us - 2_000_000
    heard = [session.take(step) for step in play_usual() if step.packet.t_begin_us >= begin_us]
    assert "The gel was touched, so the rest begins again." in heard
    assert session.list_figures()["hot_pixels"] in (None, 0.0)
    assert session.missing.endswith("of 5 seconds so far.")


def test_archive_holds_everything_but_private_things(tmp_path, monkeypatch):
    monkeypatch.setenv("USER", "anna-private")
    recording = tmp_path / "recording.aedat4"
    RecordingWriter(recording).close()
    camera = {"product": "DAVIS of anna-private", "note": "number 00001055 on host"}
    session = make_waiting_session()
    session.next(is_skipped=True)
    report = make_report(
        session, SourceKind.CAMERA, camera, is_simulated=False, secrets={"00001055"}
    )
    out = tmp_path / "a.hello.zip"
    write_archive(out, report, session.spans, recording)
    with zipfile.ZipFile(out) as archive:
        assert archive.testzip() is None
        assert {each.date_time for each in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        content = archive.read("hello.json").decode()
        rows = list(csv.DictReader(io.StringIO(archive.read("prompts.csv").decode())))
        assert archive.read("recording.aedat4") == recording.read_bytes()
    assert "anna-private" not in content
    assert "00001055" not in content
    assert str(tmp_path) not in content
    assert json.loads(content)["left_out"]
    assert rows[0]["prompt"] == "light"
    assert rows[0]["skipped"] == "1"


def test_full_disk_leaves_no_part(tmp_path):
    recording = tmp_path / "recording.aedat4"
    recording.write_bytes(b"x")
    session = make_waiting_session()
    report = make_report(session, SourceKind.SIMULATION, {}, is_simulated=True)
    with pytest.raises(FileNotFoundError):
        write_archive(tmp_path / "none" / "a.hello.zip", report, session.spans, recording)
    assert [each.name for each in tmp_path.iterdir()] == ["recording.aedat4"]


def plug(folder: Path) -> Path:
    """Plugs a DAVIS into a folder like Linux's list of USB devices."""
    camera = folder / "2-1"
    camera.mkdir()
    for name, text in {
        "idVendor": "152a",
        "idProduct": "841a",
        "bcdDevice": "0006",
        "busnum": "2",
        "devnum": "5",
        "serial": "00001055",
        "product": "DAVIS 346",
        "speed": "5000",
    }.items():
        (camera / name).write_text(text)
    (camera / "descriptors").write_bytes(b"\x12\x01\x00\x03")
    return folder


def test_davis_is_only_read(tmp_path, monkeypatch):
    camera = ScriptedCamera()
    monkeypatch.setattr("neurotouch_hid.source.davis.camera.Usb", lambda: camera)
    facts, secrets = read_davis("davis:", plug(tmp_path))
    assert facts["registers"]["SYSINFO_LOGIC"] == 18
    assert facts["registers"]["DVS_COLUMNS"] == 260
    assert facts["descriptors"] == "12010003"
    assert "00001055" not in json.dumps(facts)
    assert secrets == {"00001055"}
    assert camera.log == []  # nothing was written
    assert camera.n_open == 0


def test_video_camera_is_only_read():
    camera = FakeCamera()
    before = dict(camera.controls)
    linux = FakeLinux(camera)
    with VideoCameraSource(linux=linux) as source:
        set_up = dict(camera.controls)
        facts = read_opened(source, linux)
    assert facts["rates_by_mode"]["YUYV 320x240"] == [125.0, 60.0]
    assert facts["controls"]["gain"]["most"] == 100
    assert "usb-" not in json.dumps(facts)
    assert set_up != before  # play fixes some
    assert camera.controls == set_up  # and that is all


class Person:
    """Types a line whenever it is looked for; leaves at the end."""

    def __init__(self, *lines: str) -> None:
        self.lines = list(lines)

    def poll(self) -> str | None:
        return self.lines.pop(0) if self.lines else "q"


def run(tmp_path, monkeypatch, *lines: str):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("neurotouch_hid.cli.ui.keyboard.Keyboard", lambda: Person(*lines))
    return CliRunner().invoke(command, ["try", "--source", "sim:rest"])


def test_whole_command_by_keyboard(tmp_path, monkeypatch):
    result = run(tmp_path, monkeypatch, "?", "r", *["s"] * len(PROMPTS))
    assert result.exit_code == 0, result.output
    assert "SIMULATED" in result.output
    assert "Nothing was sent." in result.output
    assert [each.name for each in tmp_path.iterdir()] == ["try.hello.zip"]
    again = CliRunner().invoke(command, ["try", "--source", "sim:rest"])
    assert "exists already" in again.exception.message


def test_leaving_saves_nothing(tmp_path, monkeypatch):
    result = run(tmp_path, monkeypatch, "s")
    assert "Nothing was saved." in result.output
    assert [each.name for each in tmp_path.iterdir()] == []
