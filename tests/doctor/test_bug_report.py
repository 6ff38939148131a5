"""Nothing private is in the report, whatever it was found in."""

import json
import os
import pwd
import socket

from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.doctor import CheckStatus, Finding
from neurotouch_hid.doctor.bug_report import format_report, gather, list_rules, make_cleaner
from neurotouch_hid.doctor.inventory import Pad
from neurotouch_hid.gel_sentences import report_gel
from neurotouch_hid.messages import GelProblem, GelState

SECRETS = ("anna", "/home/anna", "Anna Example", "annas-laptop", "00000216")


def rules_for(monkeypatch):
    account = pwd.struct_passwd(
        ("anna", "x", 1000, 1000, "Anna Example,,,", "/home/anna", "/bin/sh")
    )
    monkeypatch.setattr(pwd, "getpwuid", lambda uid: account)
    monkeypatch.setattr(socket, "gethostname", lambda: "annas-laptop.example.org")
    monkeypatch.setenv("HOME", "/home/anna")
    monkeypatch.setenv("USER", "anna")
    return list_rules(["00000216", ""])


def test_each_secret_is_replaced(monkeypatch):
    clean = make_cleaner(rules_for(monkeypatch))
    said = {
        "a": "/home/anna/.config/neurotouch/user.yaml of anna",
        "b": ["Anna Example on annas-laptop", ("davis:00000216", 7, None, True)],
        "c": {"/home/anna": "camera 00000216, davis:00009999"},
        "d": "aa:bb:cc:dd:ee:ff at 192.168.1.5, not 127.0.0.1",
        "e": "banana and Savannah keep their letters",
    }
    assert clean(said) == {
        "a": "~/.config/neurotouch/user.yaml of USER",
        "b": ["NAME on HOST", ["davis:SERIAL", 7, None, True]],
        "c": {"~": "camera SERIAL, davis:SERIAL"},
        "d": "ADDRESS at ADDRESS, not 127.0.0.1",
        "e": "banana and Savannah keep their letters",
    }


def test_no_secret_survives_in_any_surrounding(monkeypatch):
    clean = make_cleaner(rules_for(monkeypatch))

    @given(
        st.lists(st.sampled_from([*SECRETS, "x", "user", "davis:00000216"]), max_size=8),
        st.sampled_from([" ", "/", ": ", "\n", "'", '"', ".", ",", "@", "-", "_", "="]),
    )
    def check(words, between):
        text = clean(between.join(words))
        for secret in SECRETS:
            assert secret not in text

    check()


def test_names_that_a_person_has_given_are_not_in_the_report(monkeypatch, tmp_path):
    """Recordings, profiles and devices are often called after people and what they have."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "anna"))
    profiles = tmp_path / "anna/neurotouch/profiles"
    profiles.mkdir(parents=True)
    (profiles / "anna-after-stroke.yaml").write_text("version: 1\nname: anna-after-stroke\n")
    (profiles.parent / "user.yaml").write_text("version: 1\nslots: [racing, bens-hand]\n")
    recording = "/media/stick/patient 4711.aedat4"
    told = f"'{recording}' ended; patient 4711 of /x/other-patient.aedat4"
    status = {
        "source": f"file:{recording}",
        "profile": "anna-after-stroke",
        "errors": [{"at": 1.0, "error": f"Profile 'anna-after-stroke': {told}"}],
        "keyboard": "Anna's Keys can stop the driver",
        "copilot": "Anna's DualSense plays along",
        "gel": report_gel(GelState(problem=GelProblem.MISSING, missing=(3, 40), missing_px=())),
    }
    monkeypatch.setattr("neurotouch_hid.doctor.bug_report.find_driver", lambda: status)
    monkeypatch.setattr(
        "neurotouch_hid.doctor.bug_report.find_pads",
        lambda: [
            Pad("/dev/e1", "Anna's DualSense", (5, 1, 2, 3), "aa", False, False, True),
            Pad("/dev/e2", "NeuroTouch pad", (3, 1, 2, 3), "", True, True, True),
        ],
    )
    inputs = tmp_path / "inputs"
    inputs.write_text('I: Bus=0005\nN: Name="Anna\'s Keys"\nN: Name="NeuroTouch pad"\n')
    monkeypatch.setattr("neurotouch_hid.doctor.bug_report._INPUTS", inputs)
    faulty = (
        "/x/user.yaml:2:5: error[NT112]: 'dystonia' is not one of: none, light\n"
        "     2 |     filter: dystonia\n       |     ^^^^^^^^ did you mean dyst?"
    )
    found = "'bens-hand' does not exist; 'racing' does."
    findings = [Finding(CheckStatus.FAILED, each, check="profiles") for each in (found, faulty)]
    report = gather(findings)
    text = json.dumps(report) + format_report(report)
    for private in ("stroke", "4711", "patient", "stick", "bens", "Anna", "anna", "dyst"):
        assert private not in text, private
    driver = report["driver"]
    assert driver["source"] == "file:RECORDING 1"
    assert driver["gel"]["named"] == "row 1: 4; row 5: 3"
    assert "missing" not in driver["gel"]
    assert driver["profile"] == "PROFILE 1"
    assert report["doctor"][0]["sentence"] == "'PROFILE 2' does not exist; 'racing' does."
    assert report["doctor"][1]["sentence"] == "/x/user.yaml:2:5: error[NT112]"
    assert [pad["name"] for pad in report["pads"]] == ["DEVICE 1", "NeuroTouch pad"]


def test_the_real_report(monkeypatch, tmp_path):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path / "person"))
    monkeypatch.setenv("SECRET_TOKEN", "hunter2")
    monkeypatch.setenv("XDG_CURRENT_DESKTOP", "GNOME")
    found = f"{tmp_path / 'person'}/.config is read-only for {os.environ.get('USER', 'nobody')}."
    report = gather([Finding(CheckStatus.FAILED, found, "Fix it.", check="profiles")])
    text = json.dumps(report)
    assert "hunter2" not in text
    assert str(tmp_path / "person") not in text
    assert "~/.config is read-only" in text
    assert report["environment"]["XDG_CURRENT_DESKTOP"] == "GNOME"
    assert report["packages"]["numpy"].count(".") == 2
    assert report["left_out"]
    plain = format_report(report)
    assert "  FAILED profiles: ~/.config is read-only" in plain
    assert "left out:" in plain
