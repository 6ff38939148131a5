"""``neurotouch calibrate`` through a pipe: asked, read out, answered, saved, undone."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from neurotouch_hid.client import ask, ask_status
from neurotouch_hid.profile import load_user
from tests.processes import run_command, run_neurotouch, start_neurotouch
from tests.waiting import wait_until

PLAYED = """
import sys
from neurotouch_hid.cli.calibrate_result import conclude, relieve_weak_sides
from neurotouch_hid.cli.ui.keyboard import Keyboard
from neurotouch_hid.profile import load_user, rehearse
from neurotouch_hid.profile.calibration import CalibrationSession

session = CalibrationSession(load_user(), guided=False)
for gesture in rehearse(sys.argv[1]):
    session.take(gesture)
keyboard, yes, as_json = Keyboard(), "--yes" in sys.argv, "--json" in sys.argv
if conclude(session, keyboard, yes=yes, plain=True, as_json=as_json) and not as_json:
    relieve_weak_sides(session, None if yes else keyboard, plain=True)
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
    return run_command(sys.executable, *arguments, code=None, input=answers, env=dict(os.environ))


def conclude(script, *options, answers=""):
    done = launch("-c", PLAYED, script, *options, answers=answers)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_what_came_out_is_shown_saved_and_relieved(home):
    output = conclude(WEAK_ZOOM, answers="1\n1\n2\n")
    assert "Tremor: 5.1 Hz, 1.0 mm" in output or "Tremor: 5.0 Hz, 1.0 mm" in output
    assert "pinch: was that of the reference hand, now 0.6 to " in output
    assert "zoom: was that of the reference hand, now 0.6 to 2.4 mm" in output
    settings = load_user()
    assert settings.range.zoom.full == 2.4
    assert settings.filter == "medium"
    assert settings.range.push_left is None
    assert "zoom goes" in output
    profile = (home / "profiles" / "default.yaml").read_text(encoding="utf-8")
    assert "do: {trigger: right, value: 1.0, mode: toggle}" in profile
    assert "when: {gesture: pinch, press: long}" in profile

    output = conclude(AGAIN, answers="1\n")
    assert "zoom: was 0.6 to 2.4 mm, now 0.6 to 4 mm" in output
    assert load_user().range.zoom.full == 4.0
    done = launch("-m", "neurotouch_hid", "calibrate", "--undo")
    assert done.returncode == 0
    assert load_user().range.zoom.full == 2.4


WEAK_LEFT = "rest 1s; " + "; rest 1s; ".join(
    (
        *(2 * ["push right 8mm 200ms hold 300ms"]),
        *(2 * ["push left 3mm 200ms hold 300ms"]),
        "rest 1s",
    )
)


@pytest.mark.parametrize(
    ("answers", "turned"),
    [("1\n2\n", "push right double"), ("1\n3\n3\n", "push up tap")],
)
def test_a_weak_side_of_a_stick_is_relieved_too(home, answers, turned):
    output = conclude(WEAK_LEFT, answers=answers)
    assert f"For you: {turned} turns round push -> stick left" in output
    profile = (home / "profiles" / "default.yaml").read_text(encoding="utf-8")
    assert "do: {stick: left, range_mm: [1.0, 8.0], curve: {expo: 0.3}, invert_x: true}" in profile
    assert "do: {layer: base-turned}" in profile


def test_a_persons_own_tremor_can_be_taken_out(home):
    output = conclude(WEAK_ZOOM, answers="3\n1\n1\n")
    assert "3. Use medium, and take out your own tremor of 5." in output
    assert 4.5 < load_user().tremor_hz < 5.5
    assert load_user().filter == "medium"


def test_nothing_is_saved_against_a_persons_will(home):
    output = conclude(WEAK_ZOOM, answers="2\n2\n")
    assert "Nothing was saved" in output
    done = launch("-c", PLAYED, WEAK_ZOOM, answers="nonsense\n9\n")
    assert done.returncode != 0
    assert "'nonsense' is not one of the numbers" in done.stdout
    assert "No movement was made twice" in conclude("rest 1s; pinch 8mm; rest 1s")
    assert not home.exists()


def test_a_program_gets_what_came_out_and_saves_by_yes_only(home):
    told = json.loads(conclude(WEAK_ZOOM, "--json"))
    assert told["changed"] is False
    assert not home.exists()
    movements = {movement["movement"]: movement for movement in told["movements"]}
    assert movements["zoom"]["now"]["full"] == 2.4
    assert movements["zoom"]["used"] is True
    assert len(movements["pinch"]["peaks_mm"]) == 2
    assert 4.0 < told["tremor"]["frequency_hz"] < 6.0
    assert [(side["weak"], side["strong"]) for side in told["weak"]] == [("zoom", "pinch")]
    assert told["weak"][0]["share"] < 0.5
    told = json.loads(conclude(WEAK_ZOOM, "--json", "--yes"))
    assert told["changed"] is True
    assert load_user().range.zoom.full == 2.4
    assert json.loads(conclude("rest 1s", "--json"))["status"] == "WARNING"


def test_undo_takes_back_the_calibration_not_what_was_changed_later(home):
    conclude(WEAK_ZOOM, "--yes")
    assert load_user().range.zoom is not None
    undo = ["calibrate", "--undo"]
    for arguments in (["profile", "set", "user", "feedback.sound", "tones"], undo):
        done = launch("-m", "neurotouch_hid", *arguments)
        assert done.returncode == 0, done.stderr
    assert load_user().range.zoom is None
    assert load_user().feedback.sound == "tones"
    done = launch("-m", "neurotouch_hid", "calibrate", "--undo")
    assert done.returncode == 6
    assert "There is no calibration to undo" in done.stderr


def test_ten_calibrations_are_kept(home):
    from neurotouch_hid.profile.editing import take_user

    for i in range(14):
        edited = take_user(lambda i=i: f"{i:02d}")
        text = f"version: 1\nrange:\n  zoom: {{rest: 0.6, full: {3 + i / 10}}}\n"
        edited.save(edited.text.rewrite(text))
    versions = take_user(str).store.versions()
    assert len(versions) == 10
    assert "full: 4.2" in versions[0].path.read_text(encoding="utf-8")


def test_a_movement_is_asked_for_and_read_out_while_the_gel_is_live():
    words = ("calibrate", "push_right", "--source", "sim:push-right")
    with start_neurotouch(*words, stdin=subprocess.PIPE, stderr=None) as process:
        process.stdin.write("\n\n")
        process.stdin.flush()  # the pipe stays open, as a keyboard does
        lines = process.stdout.read().splitlines()
    assert process.returncode == 0
    assert lines[0] == "SIMULATED: this measures no hand."
    assert lines[1].startswith("Enter = next. A letter, then Enter: S = ")
    assert lines[2].startswith("Step 1 of 3. Rest your hand")
    assert any("Step 3 of 3. Push to the right, as far as is comfortable" in li for li in lines)
    assert any(line.endswith(" millimetres, good, 1 of 2") for line in lines)
    assert "No movement was made twice" in lines[-1]


def test_time_that_is_over_before_the_first_step_is_told(home):
    words = ("calibrate", "--source", "sim:rest", "--seconds", "1")
    with start_neurotouch(*words, stdin=subprocess.PIPE, stderr=None) as process:
        lines = process.stdout.read().splitlines()  # the input stays open, as a keyboard does
    assert process.returncode == 0
    assert lines[3:] == [
        "The 1 s are over in step 1 of 10. Without --seconds each step lasts until you press "
        "Enter.",
        "WARNING No movement was made twice and far enough; nothing was saved.",
    ]


def test_input_that_ends_leaves_nothing_unsaid(home):
    done = launch("-m", "neurotouch_hid", "calibrate", "--source", "sim:rest")
    assert done.returncode == 1
    assert done.stdout.splitlines()[-1] == "Nothing was saved."
    assert done.stderr.splitlines()[-2:] == [
        "Error: The input has ended, so no more questions can be answered.",
        "Fix: Answer in a terminal. Ctrl-D ends the input, Ctrl-C the command.",
    ]


def test_where_speech_is_wanted_everything_is_spoken(home, tmp_path, monkeypatch):
    home.mkdir()
    (home / "user.yaml").write_text("feedback: {sound: speech}\n", encoding="utf-8")
    said = tmp_path / "said"
    spd_say = tmp_path / "bin" / "spd-say"
    spd_say.parent.mkdir()
    spd_say.write_text(f'#!/bin/sh\nfor last; do :; done; echo "$last" >> {said}\n')
    spd_say.chmod(0o755)
    monkeypatch.setenv("PATH", f"{spd_say.parent}:{os.environ['PATH']}")
    source = ("--source", "sim:push-right", "--seconds", "6", "--speed", "max")
    done = launch("-m", "neurotouch_hid", "calibrate", *source, "--json")
    assert done.returncode == 0, done.stderr
    spoken = said.read_text(encoding="utf-8").splitlines()
    assert spoken[0].startswith("SIMULATED")
    assert len(spoken) > 1
    assert all(words.endswith("millimetres, good") for words in spoken[1:])
    assert set(spoken) <= set(done.stderr.splitlines())


def test_one_can_stop_at_any_time(home):
    done = launch(
        *("-m", "neurotouch_hid", "calibrate", "--source", "sim:rest"), answers="?\n\ns\nb\nq\n"
    )
    assert done.returncode == 130
    assert done.stdout.splitlines()[-1] == "Nothing was saved."
    assert list(home.iterdir()) == []


@pytest.fixture
def driver(tmp_path_factory, monkeypatch):
    """A driver that plays every gesture, again and again."""
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path_factory.mktemp("run") / "neurotouch"))
    options = ("--source", "sim:tour", "--device", "memory", "--show", "nothing")
    process = start_neurotouch("run", *options, stdout=None)
    for line in process.stderr:
        if "Gamepad ready" in line:
            break
    yield process
    process.terminate()
    process.communicate()


def test_what_the_running_driver_sees_is_measured_and_the_driver_paused_meanwhile(home, driver):
    said = []
    with start_neurotouch(
        "calibrate", "push_right", "push_left", stdin=subprocess.PIPE, stderr=subprocess.STDOUT
    ) as process:
        for line in process.stdout:
            said.append(line)
            if "Step 1" in line:
                assert ask_status()["state"] == "paused"
                process.stdin.write("\n")
            elif "Step 2" in line:
                process.stdin.write("\n")
            elif "millimetres" in line and "q" not in said:
                said.append("q")
                process.stdin.write("q\n")
            process.stdin.flush()
    assert process.returncode == 130, said  # Q saves nothing
    text = "".join(said)
    assert "SIMULATED" in text
    assert "The running driver is paused meanwhile." in text
    assert "Resumed. The next gesture counts." in text
    wait_until(lambda: ask_status()["state"] == "running")


def test_a_panic_meanwhile_stays_after_the_calibration(home, driver):
    with start_neurotouch("calibrate", stdin=subprocess.PIPE) as process:
        for line in process.stdout:
            if "Step 1" in line:
                ask("panic")
                process.stdin.write("q\n")
                process.stdin.flush()
    assert process.returncode == 130
    assert ask_status()["state"] == "panic"


def test_a_driver_goes_on_after_the_last_of_two_calibrations_and_after_a_killed_one(home, driver):
    def begin():
        process = start_neurotouch("calibrate", stdin=subprocess.PIPE)
        while "Step 1" not in process.stdout.readline():
            pass
        return process

    first, second = begin(), begin()
    out, _ = first.communicate("q\n")
    assert "Still paused, until another program has ended too." in out
    assert ask_status()["state"] == "paused"
    second.kill()
    second.communicate()
    wait_until(lambda: ask_status()["state"] == "running")


def test_a_driver_goes_on_when_the_calibration_cannot_say_anything(home, driver):
    with Path("/dev/full").open("w") as full:
        run_neurotouch("calibrate", code=1, capture_output=False, stdin=full, stdout=full)
    assert ask_status()["state"] == "running"


def test_what_is_saved_acts_in_the_running_driver_at_once(home, driver):
    done = launch("-m", "neurotouch_hid", "profile", "set", "user", "filter", "strong", "--json")
    assert "It applies now" in json.loads(done.stdout)["notes"][0]
    done = launch("-m", "neurotouch_hid", "profile", "new", "mine", "--json")
    assert "not the active profile" in json.loads(done.stdout)["notes"][0]
    done = launch("-m", "neurotouch_hid", "profile", "use", "mine", "--json")
    assert "'mine' is now active" in json.loads(done.stdout)["notes"][0]


def talk(answer, *arguments):
    """Runs it with a pipe that stays open, as a keyboard does; ``answer`` gets it and each line."""
    said = []
    with start_neurotouch(
        "calibrate", *arguments, stdin=subprocess.PIPE, stderr=subprocess.STDOUT
    ) as process:
        for line in process.stdout:
            said.append(line.strip())
            if (keys := answer(process, line)) is not None:
                process.stdin.write(f"{keys}\n")
                process.stdin.flush()
    return process.returncode, said


def test_after_an_end_in_the_middle_it_continues_there(home):
    """Whoever ended it: here it is killed, as by a power cut."""
    source = ("push_right", "push_left", "--source", "sim:push-right")

    def first(process, line):
        if line.startswith(("Step 1", "Step 2")):
            return ""
        if "millimetres, good" in line:
            time.sleep(0.5)
            process.kill()
        return None

    code, said = talk(first, *source)
    assert code == -9, said

    def second(_process, line):
        return "q" if line.startswith("Step") else None

    code, said = talk(second, *source)
    assert "You have done 2 of 4 steps before. It continues." in said
    assert any(line.startswith("Step 3 of 4. Push to the right") for line in said)
    assert said[-2:] == ["Nothing was saved.", "Stopped."]
    assert code == 130
    assert list(home.iterdir()) == []  # Q gives it up


def test_one_can_begin_again(home):
    source = ("push_right", "--source", "sim:push-right")
    answers = iter(["", "", "r", "q"])
    code, said = talk(lambda _, line: next(answers) if line.startswith("Step") else None, *source)
    assert code == 130
    steps = [line[:6] for line in said if line.startswith("Step")]
    assert steps == ["Step 1", "Step 2", "Step 3", "Step 1"]


def test_input_that_ends_in_the_middle_loses_nothing(home):
    done = launch("-m", "neurotouch_hid", "calibrate", "--source", "sim:rest", answers="\n\n")
    assert done.stdout.splitlines()[-2:] == [
        "Nothing was saved.",
        "What you did is kept. The next calibration continues there.",
    ]
    done = launch("-m", "neurotouch_hid", "calibrate", "--source", "sim:rest", answers="q\n")
    assert "You have done 2 of 10 steps before. It continues." in done.stdout
