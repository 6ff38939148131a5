"""Nothing private is in the report, whatever it was found in."""

import json
import os
import pwd
import socket

from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.doctor import CheckStatus, Finding
from neurotouch_hid.doctor.bug_report import format_report, gather, list_rules, make_cleaner

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
