"""A first meeting with an event camera of another maker: simulated packets, a doubled library."""

import json
import zipfile

import pytest
from click.testing import CliRunner

from neurotouch_hid.cli.hello import command
from neurotouch_hid.doctor.hello.rig_settings import load_rig
from neurotouch_hid.doctor.hello.session import Session
from neurotouch_hid.source.events.source import EventCameraSource
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.script import sequence
from neurotouch_hid.source.simulator.strokes import push, twist
from tests.source.events.fake_library import Camera, Library, magnify

_REST_US, _GAP_US = 6_600_000, 1_300_000
_HURRY_US = 600_000_000
"""Old slices are as good as new ones: the packets come all at once."""


class Person:
    """Presses Enter at times of the camera; what comes after them is left out."""

    def __init__(self, monkeypatch, times_us) -> None:
        self.session, self.times_us = None, list(times_us)

        def note(session, *slice_):
            self.session = session
            return take(session, *slice_)

        take = Session.take
        monkeypatch.setattr(Session, "take", note)

    def poll(self) -> str | None:
        if not self.times_us:
            return "s"
        if self.session is None or self.session.end_us < self.times_us[0]:
            return None
        n_before = len(self.session.spans)
        if self.session.missing and n_before < 2:
            return ""
        self.times_us.pop(0)
        return ""


def meet(tmp_path, monkeypatch, title="CenturyArks VGA", **simulation):
    script = sequence("hello", push(0.0, 7.0), twist(0.5), rest_us=_REST_US, gap_us=_GAP_US)
    camera = Camera(title)
    for packet in Simulator(script, seed=3, **simulation):
        camera.show(packet.t_end_us, magnify(packet.events, camera.view))
    library = Library(camera)
    for module in ("source", "library"):
        monkeypatch.setattr(
            f"neurotouch_hid.source.events.{module}.load_library", lambda: library
        )
    monkeypatch.setitem(EventCameraSource.__init__.__kwdefaults__, "max_delay_us", _HURRY_US)
    monkeypatch.chdir(tmp_path)
    times = [500_000, _REST_US - 100_000]
    times += [stroke.end_us + _GAP_US - 100_000 for stroke in script.strokes]
    person = Person(monkeypatch, times)
    monkeypatch.setattr("neurotouch_hid.cli.ui.keyboard.Keyboard", lambda: person)
    result = CliRunner().invoke(command, ["desk", "--source", "events:"])
    print(result.output)
    assert result.exit_code == 0, (result.output, result.exception)
    path = tmp_path / "desk.hello.zip"
    with zipfile.ZipFile(path) as archive:
        return path, json.loads(archive.read("hello.json")), archive.namelist()


def test_whole_hello(tmp_path, monkeypatch):
    path, report, names = meet(tmp_path, monkeypatch)
    print(json.dumps(report, indent=1))
    print(names, load_rig(path).content.decode())
    assert 0
