"""What belongs to the person."""

import datetime
import os
from types import SimpleNamespace

import pytest

from neurotouch_hid.doctor import person
from neurotouch_hid.doctor.examination import Check, examine
from neurotouch_hid.doctor.finding import CheckStatus
from tests.device.test_chord import Machine


@pytest.fixture
def config(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    folder = tmp_path / "config/neurotouch"
    folder.mkdir(parents=True)
    return folder


BY_HAND = "version: 1\nrange:\n  zoom: {rest: 1.0, full: 3.0}\n"


def calibrated(days):
    """Told when the test runs: the tests may be collected on the day before."""
    date = datetime.datetime.now(tz=datetime.UTC).date() - datetime.timedelta(days)
    return f"# Calibrated {date}.\n{BY_HAND}"


def test_the_shipped_profiles_are_in_order(config):
    finding = person.check_profiles()
    assert finding.status is CheckStatus.OK
    assert "'default' plays first" in finding.sentence


def test_a_profile_with_a_fault_is_told_with_its_place(config):
    (config / "profiles").mkdir()
    (config / "profiles/mine.yaml").write_text("version: 1\nname: mine\nbindngs: []\n")
    (finding,) = examine([Check("profiles", person.check_profiles)])
    assert finding.status is CheckStatus.FAILED
    assert "mine.yaml:3:1" in finding.sentence


@pytest.mark.parametrize(
    ("flags", "fix"),
    [(0, "Get the right to write there."), (os.ST_RDONLY, "This disk is read-only")],
)
def test_a_folder_that_cannot_be_written_has_a_fix_that_harms_nothing(
    config, monkeypatch, flags, fix
):
    """Where no folder is there yet, the nearest one may be that of the whole system."""
    monkeypatch.setenv("XDG_CONFIG_HOME", "/nowhere/at/all")
    monkeypatch.setattr(os, "access", lambda *_: False)  # root may write everywhere
    monkeypatch.setattr(os, "statvfs", lambda _: SimpleNamespace(f_flag=flags))
    finding = person.check_profiles()
    assert "but / cannot be written" in finding.sentence
    assert finding.fix.startswith(fix)
    assert "chown" not in finding.fix


def test_a_favourite_that_is_gone(config):
    (config / "user.yaml").write_text("version: 1\nslots: [default, gone]\n")
    finding = person.check_profiles()
    assert finding.status is CheckStatus.FAILED
    assert "'gone'" in finding.sentence


@pytest.mark.parametrize(
    ("write", "status", "words"),
    [
        (lambda: "version: 1\n", CheckStatus.SKIPPED, "neurotouch calibrate"),
        (lambda: calibrated(3), CheckStatus.OK, "1 of 8 movements are calibrated, 3 days ago."),
        (lambda: calibrated(-9), CheckStatus.OK, "1 of 8 movements are calibrated, 0 days ago."),
        (lambda: calibrated(400), CheckStatus.WARNING, "400 days ago"),
        (lambda: BY_HAND, CheckStatus.OK, "by hand"),
    ],
)
def test_calibration(config, write, status, words):
    (config / "user.yaml").write_text(write())
    finding = person.check_calibration()
    assert finding.status is status
    assert words in finding.sentence


def test_sound_that_nobody_wants(config):
    assert person.check_sound().status is CheckStatus.SKIPPED


def test_sound_that_can_be_played_and_cannot(config, tmp_path, monkeypatch):
    (config / "user.yaml").write_text("version: 1\nfeedback: {sound: speech}\n")
    monkeypatch.setenv("PATH", str(tmp_path))
    finding = person.check_sound()
    assert finding.status is CheckStatus.WARNING
    assert finding.commands == ("sudo apt install speech-dispatcher",)
    (tmp_path / "spd-say").write_text("#!/bin/sh\n")
    (tmp_path / "spd-say").chmod(0o755)
    assert person.check_sound().status is CheckStatus.OK


@pytest.fixture
def machine(tmp_path):
    return Machine(tmp_path)


def test_the_keys_are_heard_in_any_time(config, machine):
    keyboard = machine.plug(0)
    said = []

    def wait(happened):
        """The person presses what was said last."""
        keyboard.press(
            *(f"KEY_{name.upper()}" for name in said[-1].split(" together")[0][5:].split(" + "))
        )
        while not happened():
            pass
        return True

    finding = person.try_chords(said.append, wait, nodes=machine.nodes, system=machine.system)
    assert finding.status is CheckStatus.OK
    assert (
        "Hold Backspace + Esc + Enter together (panic). There is no time limit; S and Enter skips."
        in said
    )


def test_one_may_skip(config, machine):
    machine.plug(0)
    places = {"nodes": machine.nodes, "system": machine.system}
    finding = person.try_chords(lambda text: None, lambda happened: False, **places)
    assert finding.status is CheckStatus.SKIPPED
    answers = iter([True, False])
    finding = person.try_chords(lambda text: None, lambda happened: next(answers), **places)
    assert finding.status is CheckStatus.WARNING
