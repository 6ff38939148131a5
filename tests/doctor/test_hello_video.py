"""A webcam, and an event camera of another maker, met for the first time."""

import json
import re
import zipfile
from dataclasses import replace

import pytest
from click.testing import CliRunner

from neurotouch_hid.cli.hello import command
from neurotouch_hid.doctor.hello.answers import Word, answer_all
from neurotouch_hid.doctor.hello.camera_facts import judge_stream, read_opened, read_stream
from neurotouch_hid.doctor.hello.rig_settings import load_rig
from neurotouch_hid.doctor.hello.session import LIGHT, PROMPTS, REST, Session
from neurotouch_hid.driver.gel_file import load_gel_file
from neurotouch_hid.gel_making.plan import make_plan
from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.source.events.source import EventCameraSource
from neurotouch_hid.source.video.live import VideoCameraSource
from neurotouch_hid.vocabulary import SourceKind
from tests.doctor.attendant import Attendant
from tests.source.events.fake_library import Camera, Library, make_events
from tests.source.video.fake_camera import FakeCamera, FakeLinux
from tests.source.video.gel_pictures import draw_gel, middle_rig


class Person(Attendant):
    """Does what is asked as long as nobody must touch the gel, however slow the machine is."""

    def answer(self, session):
        if session.prompt.key not in (LIGHT, REST):
            return "s"
        return None if session.missing else ""


def plug_webcam(monkeypatch, **options) -> FakeCamera:
    """Plugs in a webcam that sends 30 pictures/s of a gel at rest."""
    fake = FakeCamera(formats={"YUYV": {(640, 480): (30,)}}, **options)
    gel = draw_gel(replace(middle_rig((640, 480), 5.0), rotation_rad=0.1), (640, 480))
    fake.draw = lambda k: gel if k % 2 else gel - (gel > 99)  # no two pictures are the same
    linux = FakeLinux(fake)
    for module in ("live", "enumeration", "capture"):
        monkeypatch.setattr(f"neurotouch_hid.source.video.{module}.Linux", lambda: linux)
    return fake


def test_whole_hello_of_a_webcam(tmp_path, monkeypatch):
    plug_webcam(monkeypatch)
    monkeypatch.chdir(tmp_path)
    Person(monkeypatch)
    result = CliRunner().invoke(command, ["desk", "--source", "video:"])
    assert result.exit_code == 0, (result.output, result.exception)
    path = tmp_path / "desk.hello.zip"
    with zipfile.ZipFile(path) as archive:
        assert "recording.mkv" in archive.namelist()
        report = json.loads(archive.read("hello.json"))
    camera = report["camera"]
    assert camera["rates_by_mode"] == {"YUYV 640x480": [30.0]}
    assert camera["controls"]["gain"]["most"] == 100
    assert camera["mode"] == "YUYV 640x480"
    assert camera["exposure_us"] == 10_000
    assert 0.0 < camera["pictures_hz"] < 35.0  # a busy machine loses some
    words = {each["point"]: each["sentence"] for each in report["answers"]}
    assert "after its stamp" in words["timing"]
    assert re.search(r"of 30 pictures/s|pictures/s are few", words["settings"])
    settings = load_rig(path).settings
    assert settings.camera == "pictures"
    assert not settings.simulated
    assert settings.px_per_mm == pytest.approx(5.0 * 260 / 480, rel=0.03)
    assert settings.turn_deg == pytest.approx(5.7, abs=0.5)
    assert settings.shot_hz is None
    assert settings.exposure_us == 10_000


def test_exposure_that_a_webcam_does_not_state_is_not_measured(monkeypatch):
    plug_webcam(monkeypatch, controls={})
    with VideoCameraSource() as source:
        next(iter(source))
        facts = read_stream(source)
        finding = judge_stream(source, PAPER_GEL, 1.0)
    assert facts["exposure_us"] is None
    assert facts["not_fixed"]
    session = Session(make_plan(load_gel_file(None).settings), "video", PROMPTS)
    answers = answer_all(session, SourceKind.VIDEO, facts, is_simulated=False, stream=finding)
    settings = next(each for each in answers if each.point == "settings")
    assert settings.word is Word.NO
    assert "exposure unknown" in settings.sentence


def test_event_camera_of_another_maker():
    camera = Camera()
    camera.show(20_000, make_events([1_000, 2_000, 3_000]))
    camera.show(40_000, make_events([21_000]))
    library = Library(camera)
    with EventCameraSource(library=library, plugged=library.list_plugged) as source:
        next(iter(source))
        facts = read_opened(source) | read_stream(source)
        finding = judge_stream(source, PAPER_GEL, 0.02)
    assert facts["name"] == "Prophesee EVK4"
    assert facts["events"] >= 3
    assert "events/s" in finding.sentence
