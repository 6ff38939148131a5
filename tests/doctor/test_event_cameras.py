"""Checks of event cameras of other makers."""

import pytest

from neurotouch_hid.doctor import event_cameras
from neurotouch_hid.doctor.event_cameras import check_event_cameras, judge_events
from neurotouch_hid.errors import CameraError
from neurotouch_hid.source.events.enumeration import EventCameraInfo
from neurotouch_hid.source.events.models import MODELS
from neurotouch_hid.source.events.plugged import list_plugged, needs_library
from neurotouch_hid.source.events.source import EventsStats
from tests.source.events.fake_library import Camera, Library

INFO = EventCameraInfo(MODELS[0], "00ca0123", "USB 3.0", "bus 2")


@pytest.fixture
def plug(monkeypatch):
    """Returns what puts cameras into the library; without any call, the library is missing."""

    def refuse():
        raise CameraError("missing")

    monkeypatch.setattr(event_cameras, "load_library", refuse)
    monkeypatch.setattr(event_cameras, "needs_library", lambda: False)

    def plug(*cameras):
        monkeypatch.setattr(event_cameras, "load_library", lambda: Library(*cameras))

    return plug


def test_cameras_are_listed_with_the_way_to_check_one(plug):
    plug(Camera(), Camera("iniVation DAVIS 346", serial="7"))
    finding = check_event_cameras()
    assert finding.status == "OK"
    assert "Prophesee EVK4 00ca0123" in finding.sentence
    assert "only tried in simulations" in finding.sentence
    assert "--source events:00ca0123" in finding.sentence
    assert "DAVIS" not in finding.sentence  # the check before has it


def test_a_camera_that_may_not_be_opened_is_a_warning(plug):
    plug(Camera(error="Access denied (insufficient permissions)"))
    finding = check_event_cameras()
    assert finding.status == "WARNING"
    assert "no right to read and write it" in finding.sentence


def test_nothing_is_said_of_a_library_that_nobody_needs(plug, monkeypatch):
    assert check_event_cameras().status == "SKIPPED"
    monkeypatch.setattr(event_cameras, "needs_library", lambda: True)
    finding = check_event_cameras()
    assert finding.status == "WARNING"
    assert "pip install 'neurotouch-hid[events]'" in str(finding)


@pytest.mark.parametrize(
    ("counts", "status", "words"),
    [
        ({}, "OK", "10,000 events/s, of which the picture of the gel gets 1,000"),
        ({"n_lost": 3}, "WARNING", "lost 3 times"),
        ({"n_cleared": 2}, "WARNING", "old data thrown away 2 times"),
        ({"limited_us": 1_500_000}, "WARNING", "1.5 s at the limit"),
        (
            {"n_events": 0, "trouble": "It is gone."},
            "FAILED",
            "No events from events:. It is gone.",
        ),
    ],
)
def test_the_events_of_a_camera_are_judged(counts, status, words):
    usual = {"n_connects": 1, "n_events": 50_000, "n_shown": 5_000, "n_lost": 0, "n_cleared": 0}
    usual |= {"limited_us": 0, "n_restarts": 0, "trouble": ""}
    finding = judge_events("events:", EventsStats(INFO, **(usual | counts)), 5.0)
    assert finding.status == status
    assert words in finding.sentence


def test_cameras_are_noticed_without_the_library(tmp_path):
    def plug_in(port, vendor, product, number):
        folder = tmp_path / port
        folder.mkdir()
        values = {"idVendor": vendor, "idProduct": product, "devnum": number}
        for name, value in values.items():
            (folder / name).write_text(value + "\n")

    plug_in("1-1", "046d", "c52b", "3")
    plug_in("2-1", "152a", "841a", "4")
    assert not needs_library(tmp_path)  # a DAVIS needs none
    plug_in("2-2", "04b4", "00f5", "5")
    assert needs_library(tmp_path)
    assert list_plugged(tmp_path) == {"152a:841a 2-1 4", "04b4:00f5 2-2 5"}
