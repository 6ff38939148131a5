"""``neurotouch calibrate`` through a pipe: asked, read out, answered, saved, undone."""

import os
import subprocess
import sys

import pytest

from neurotouch_hid.profile import load_user

PLAYED = """
import sys
from neurotouch_hid.cli.calibrate import conclude
from neurotouch_hid.cli.keyboard import Keyboard
from neurotouch_hid.profile import load_user, rehearse
from neurotouch_hid.profile.calibration import Session

session = Session(load_user(), guided=False)
for gesture in rehearse(sys.argv[1]):
    session.take(gesture)
conclude(session, Keyboard(), yes="--yes" in sys.argv, plain=True)
"""
WEAK_ZOOM = (
    "rest 1s; pinch 8mm 300ms hold 6s tremor 5hz 1mm; rest 1s; pinch 8mm; rest 1s;"
    "zoom 3mm; rest 1s; zoom 3mm; rest 1s"
)
AGAIN = "rest 1s; zoom 5mm; rest 1s; zoom 5mm"


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    return tmp_path / "neurotouch"


def launch(*arguments, answers=""):
    return subprocess.run(
        [sys.executable, *arguments],
        input=answers,
        capture_output=True,
        text=True,
        check=False,
        env=dict(os.environ),
        timeout=300,
    )


def conclude(script, answers=""):
    done = launch("-c", PLAYED, script, answers=answers)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_what_came_out_is_shown_saved_and_relieved(home):
    output = conclude(WEAK_ZOOM, "1\n1\n2\n")
    assert "Tremor: 5.1 Hz, 1.0 mm" in output or "Tremor: 5.0 Hz, 1.0 mm" in output
    assert "pinch: was a usual hand's, now 0.6 to " in output
    assert "zoom: was a usual hand's, now 0.6 to 2.4 mm" in output
    settings = load_user()
    assert settings.range.zoom.full == 2.4
    assert settings.filter == "medium"
    assert settings.range.push_left is None
    assert "zoom goes" in output
    profile = (home / "profiles" / "default.yaml").read_text(encoding="utf-8")
    assert "do: {trigger: right, value: 1.0, mode: toggle}" in profile
    assert "when: {gesture: pinch, press: long}" in profile

    output = conclude(AGAIN, "1\n")
    assert "zoom: was 0.6 to 2.4 mm, now 0.6 to 4 mm" in output
    assert load_user().range.zoom.full == 4.0
    done = launch("-m", "neurotouch_hid", "calibrate", "--undo")
    assert done.returncode == 0
    assert load_user().range.zoom.full == 2.4


def test_nothing_is_saved_against_a_persons_will(home):
    output = conclude(WEAK_ZOOM, "2\n2\n")
    assert "Nothing was saved" in output
    done = launch("-c", PLAYED, WEAK_ZOOM, answers="nonsense\n9\n")
    assert done.returncode != 0
    assert "'nonsense' is none of the numbers" in done.stdout
    assert "No movement was made twice" in conclude("rest 1s; pinch 8mm; rest 1s")
    assert not home.exists()


def test_ten_calibrations_are_kept(home):
    from neurotouch_hid.profile.editing import take_user

    for i in range(14):
        paper = take_user(lambda i=i: f"{i:02d}")
        paper.save(f"version: 1\nrange:\n  zoom: {{rest: 0.6, full: {3 + i / 10}}}\n")
    versions = take_user(str).store.versions()
    assert len(versions) == 10
    assert "full: 4.2" in versions[0].path.read_text(encoding="utf-8")


def test_a_movement_is_asked_for_and_read_out_while_the_gel_is_live():
    command = [sys.executable, "-m", "neurotouch_hid", "calibrate", "push_right"]
    with subprocess.Popen(
        [*command, "--source", "sim:push-right"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        process.stdin.write("\n\n")
        process.stdin.flush()  # the pipe stays open, as a keyboard does
        lines = process.stdout.read().splitlines()
    assert process.returncode == 0
    assert lines[0].startswith("Enter = next, S = ")
    assert lines[1].startswith("Step 1 of 3. Rest your hand")
    assert any("Step 3 of 3. Push to the right, as far as is comfortable" in li for li in lines)
    assert any(line.endswith(" millimetres, good") for line in lines)
    assert "No movement was made twice" in lines[-1]


def test_one_can_stop_at_any_time(home):
    done = launch(
        *("-m", "neurotouch_hid", "calibrate", "--source", "sim:rest"), answers="?\n\ns\nb\nq\n"
    )
    assert done.returncode == 130
    assert not home.exists()
