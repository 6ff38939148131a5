"""What the questions mean; the line here stands still unless a test turns it."""

import os
import time
from concurrent.futures import ThreadPoolExecutor, wait
from threading import Event

import pytest

from neurotouch_hid.driver.chosen import Chosen
from neurotouch_hid.driver.commands import Commands
from neurotouch_hid.driver.packet_feed import PacketFeed
from neurotouch_hid.driver.profile_watch import ProfileWatch
from neurotouch_hid.driver.program_pauses import ProgramPauses
from neurotouch_hid.driver.surroundings import Surroundings
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.profile import UserSettings, load_profile
from neurotouch_hid.runtime import Pipeline, PipelineControl
from neurotouch_hid.source import open_source
from neurotouch_hid.status import Described, check_status

PROFILE, USER = load_profile("default"), UserSettings()
CHOSEN = Chosen("default", PROFILE, USER)
DESCRIBED: Described = {
    "source": "sim:tour",
    "device": "memory",
    "keyboard": "none",
    "desktop": "none",
    "sound": "none",
    "simulated": True,
    "settings": "this user's own",
    "copilot": "none",
    "mouse": "none",
    "rumble": {"strong": 0.0, "weak": 0.0},
}


def make_commands(control, profiles, window=None, **surroundings):
    return Commands(
        control,
        profiles,
        PacketFeed(),
        ProgramPauses(control),
        open_source("sim:tour", speed="max"),
        Surroundings(**surroundings),
        lambda: DESCRIBED,
        window,
    )


@pytest.fixture
def control():
    line = Pipeline.build(PROFILE, GestureConfig(), user=USER)
    return PipelineControl(line, USER)


@pytest.fixture
def commands(control):
    watch = ProfileWatch(CHOSEN, control, Surroundings(), lambda new: None)
    yield make_commands(control, watch)
    watch.close()


@pytest.fixture
def patient(monkeypatch):
    """A machine that stands still for a moment is no silent source."""
    monkeypatch.setattr("neurotouch_hid.driver.commands._WAIT_S", 60.0)


@pytest.mark.parametrize("path", ["/tmp/\ud800.yaml", "/tmp/\x1b[2J.yaml", "/tmp/\u202e.yaml"])
def test_after_a_path_that_cannot_be_shown_the_status_can(commands, path):
    refused = commands.answer({"command": "use", "profile": path}, os.getuid())
    assert refused["error"].isprintable()
    status = commands.answer({"command": "status"}, os.getuid())
    assert status["errors"]
    assert all(error["error"].isprintable() for error in status["errors"])


def test_stop_ends_the_driver_but_not_the_service(control, commands):
    ended = []
    mine = make_commands(control, commands._profiles, end=lambda: ended.append(1))
    assert mine.answer({"command": "stop"}, os.getuid())["ok"]
    assert ended == [1]
    refused = commands.answer({"command": "stop"}, os.getuid())
    assert not refused["ok"]
    assert "sudo systemctl stop neurotouch" in refused["hint"]


def test_order_to_a_silent_source_is_noted(commands):
    answer = commands.answer({"command": "panic"}, os.getuid())
    assert answer["ok"]
    assert answer["done"] is False
    assert "No data from the source" in answer["text"]


@pytest.mark.parametrize(
    ("orders", "words", "state"),
    [
        (["pause"], "Paused", "paused"),
        (["pause", "pause"], "Already paused. Go on with: neurotouch resume", "paused"),
        (["pause", "resume"], "Resumed", "running"),
        (["resume"], "Already running.", "running"),
        (["panic"], "Stopped", "panic"),
        (["pause", "panic"], "Stopped", "panic"),
        (["panic", "panic"], "Already stopped by panic.", "panic"),
        (["panic", "pause"], "Already stopped by panic.", "panic"),  # only resume ends a panic
        (["panic", "pause", "resume", "pause"], "Paused", "paused"),
    ],
)
def test_an_answer_says_what_holds_afterwards(commands, control, patient, orders, words, state):
    with ThreadPoolExecutor(1) as asker:
        for order in orders:
            asked = asker.submit(commands.answer, {"command": order}, os.getuid())
            while not asked.done():  # the line takes its orders between two slices
                control.apply_commands()
                time.sleep(0.001)
    assert asked.result()["done"]
    assert asked.result()["text"].startswith(words)
    assert commands.answer({"command": "status"}, os.getuid())["state"] == state


def test_too_many_orders_are_refused_but_never_a_panic(commands, control):
    for _ in range(64):
        control.submit("pause")
    refused = commands.answer({"command": "resume"}, os.getuid())
    assert (refused["ok"], "too many" in refused["error"]) == (False, True)
    assert commands.answer({"command": "panic"}, os.getuid())["ok"]
    control.apply_commands()
    assert commands.answer({"command": "status"}, os.getuid())["state"] == "panic"


@pytest.mark.parametrize(
    ("question", "sentence"),
    [
        ({"command": "fly"}, "no command 'fly'"),
        ({"command": "\x1b[2J" * 100}, "no command '"),
        ({"command": "use"}, "missing"),
        ({"command": "use", "profile": 7}, "missing"),
        ({"command": "use", "profile": "nine"}, "No profile is called 'nine'"),
        ({"command": "use", "profile": "/dev/zero"}, "not a file"),
        ({"command": "use", "profile": "/\0.yaml"}, "cannot be read"),
        ({"command": "use", "profile": "x" * 60_000}, "No profile is called"),
    ],
)
def test_what_cannot_be_done_is_said(commands, question, sentence):
    answer = commands.answer(question, os.getuid())
    assert answer["ok"] is False
    assert sentence in answer["error"]
    assert "\x1b" not in answer["error"]


def test_status_tells_the_facts_too(commands):
    status = commands.answer({"command": "status"}, os.getuid())
    assert check_status(status) == status
    assert (status["source"], status["version"], status["profile"]) == ("sim:tour", 1, "default")
    assert status["silent_s"] >= 0.0


@pytest.fixture
def gate():
    """Until it opens, each profile is still being loaded."""
    return Event()


@pytest.fixture
def load_through(control, gate):
    """Commands whose profiles wait at the gate, and then cannot be used if there is a fault."""
    watches = []

    def make(fault: NeuroTouchError | None = None) -> Commands:
        def prepare(_new) -> None:
            gate.wait()
            if fault is not None:
                raise fault

        watches.append(ProfileWatch(CHOSEN, control, Surroundings(), prepare))
        return make_commands(control, watches[-1])

    yield make
    gate.set()
    for watch in watches:
        watch.close()


@pytest.mark.parametrize(("command", "name"), [("reload", "default"), ("use", "racing")])
@pytest.mark.parametrize("fault", [None, NeuroTouchError("It has an error.", hint="Mend it.")])
def test_what_is_loaded_slowly_is_answered_in_the_end(load_through, gate, command, name, fault):
    commands, question = load_through(fault), {"command": command, "profile": name}
    with ThreadPoolExecutor(1) as asker:
        asked = asker.submit(commands.answer, question, os.getuid())
        assert not wait([asked], timeout=1.5).done
        gate.set()
    if fault is None:
        assert asked.result() == {
            "ok": True,
            "done": True,
            "profile": name,
            "text": f"Profile '{name}' is now active.",
        }
    else:
        assert asked.result() == {"ok": False, "error": "It has an error.", "hint": "Mend it."}


def test_what_is_not_loaded_in_time_is_no_success(load_through, monkeypatch):
    monkeypatch.setattr("neurotouch_hid.driver.commands.LOADING_S", 0.1)
    answer = load_through().answer({"command": "reload"}, os.getuid())
    assert answer["ok"] is False
    assert answer["error"] == "The profile is still being loaded after 0.1 s."
    assert "neurotouch status" in answer["hint"]


def test_use_answers_with_the_profile_that_holds(commands, patient):
    answer = commands.answer({"command": "use", "profile": "racing"}, os.getuid())
    assert answer["done"]
    assert "'racing'" in answer["text"]
