"""Everything around a pipeline is opened on entry, and closed again if that fails half way."""

import threading
from pathlib import Path

import pytest

from neurotouch_hid.client import ask_status
from neurotouch_hid.driver import attachments
from neurotouch_hid.driver.attachments import Attachments
from neurotouch_hid.driver.chosen import Chosen
from neurotouch_hid.driver.control_socket import ControlSocket
from neurotouch_hid.driver.pad_opening import open_pad
from neurotouch_hid.driver.people import People
from neurotouch_hid.driver.settings import DriverSettings
from neurotouch_hid.driver.surroundings import Surroundings
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.players import find_runtime_folder
from neurotouch_hid.profile import UserSettings, load_profile
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source import open_source


@pytest.fixture
def make():
    """Makes attachments of a driver whose pipeline no slice moves; all parts are real."""
    profile, user = load_profile("default"), UserSettings()
    source = open_source("sim:rest", speed="max")
    pad = open_pad("memory", (), DriverSettings())

    def make(socket, **surroundings):
        pipeline = Pipeline.build(profile, GestureConfig(), user=user)
        chosen = Chosen("default", profile, user)
        return Attachments(socket, pipeline, source, pad, chosen, Surroundings(**surroundings))

    yield make
    pad.device.close()


@pytest.fixture
def socket():
    with ControlSocket(find_runtime_folder()) as socket:
        yield socket


def list_open() -> tuple[set[str], int]:
    """Returns the names of the threads, and how many descriptors are open."""
    return {each.name for each in threading.enumerate()}, len(list(Path("/proc/self/fd").iterdir()))


def test_nothing_is_opened_before_the_block_is_entered(make, socket):
    before = list_open()
    made = make(socket)
    assert list_open() == before
    with made:
        threads, _ = list_open()
        assert {"profiles", "control socket", "feed"} <= threads
        assert len(made.taps) == 3


def test_what_was_opened_is_closed_if_the_rest_cannot_be(make, socket, monkeypatch):
    def fail(*_):
        raise OSError(24, "Too many open files")

    make(None)  # loads what is loaded once
    before = list_open()
    monkeypatch.setattr(attachments, "Publisher", fail)
    with pytest.raises(OSError, match="Too many open files"), make(socket):
        pass
    assert list_open() == before


def test_a_service_plays_no_sound_and_reads_no_keyboard(make, socket, tmp_path):
    with make(socket, people=People(tmp_path)) as made:
        assert len(made.taps) == 2
        status = ask_status()
    assert status["sound"].startswith("played in the session of the person")
    assert status["keyboard"].startswith("the service may not read keyboards")


def test_status_says_whose_values_apply(make, socket, tmp_path, monkeypatch):
    monkeypatch.setenv("CONFIGURATION_DIRECTORY", str(tmp_path))
    with make(socket):
        assert ask_status()["settings"] == "this user's own"
        values = tmp_path / "user.yaml"
        values.write_text("version: 1\n")
        assert ask_status()["settings"] == f"the machine's, {values}, until this user saves values"


def test_status_says_why_nothing_comes_from_the_source(make, socket):
    with make(socket) as made:
        assert ask_status()["source"] == "sim:rest"
        made._source.trouble, made._source.n_restarts = "No camera of this number was found.", 0
        assert ask_status()["source"] == "sim:rest. No camera of this number was found."
        made._source.trouble, made._source.n_restarts = "", 2
        said = "sim:rest, restarts because its data made no sense: 2"
        assert ask_status()["source"] == said
