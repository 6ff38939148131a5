"""What the program says: sentences that people have stumbled over, each as they met it."""

import json
import os
import sys

import click
import pytest
from click.testing import CliRunner

from neurotouch_hid import client
from neurotouch_hid.cli.control import pause
from neurotouch_hid.cli.demo import command as demo
from neurotouch_hid.cli.explain import command as explain
from neurotouch_hid.cli.main import cli
from neurotouch_hid.cli.pointing import _format
from neurotouch_hid.cli.profile.changing import bind, new, set_command, use
from neurotouch_hid.cli.profile.history import _tell_time, delete, undo
from neurotouch_hid.cli.profile.looking import list_command, show
from neurotouch_hid.cli.run import command as run
from neurotouch_hid.cli.status import command as status
from neurotouch_hid.cli.ui.keyboard import Keyboard
from neurotouch_hid.cli.ui.options import PlainName
from neurotouch_hid.cli.ui.output import choose
from neurotouch_hid.cli.ui.usage_errors import WrongUsage
from neurotouch_hid.device.inputs import discovery
from neurotouch_hid.driver.control_socket import ControlSocket
from neurotouch_hid.errors import (
    AlreadyRunningError,
    DeviceError,
    NeuroTouchError,
    PageError,
    ProfileError,
    SourceError,
)
from neurotouch_hid.files.yaml_document import parse_document
from neurotouch_hid.gel_sentences import report_gel
from neurotouch_hid.messages import GelProblem, GelState
from neurotouch_hid.page.server import open_sockets
from neurotouch_hid.players import find_runtime_folder
from neurotouch_hid.profile.editing import find_own_path, locate_bindings
from neurotouch_hid.profile.rehearsal.script import parse_script
from neurotouch_hid.source.simulator import find_scene


def test_address_of_another_machine_is_not_blamed_on_the_port():
    with pytest.raises(PageError) as caught:
        open_sockets("1.2.3.4", 0)
    assert caught.value.message == "This machine has no address 1.2.3.4."
    assert caught.value.hint == "See which it has: ip address"


def test_taken_port_is_named():
    first = open_sockets(None, 0)
    try:
        with pytest.raises(PageError, match=r"^Another program uses port \d+\.$"):
            open_sockets(None, first[0].getsockname()[1])
    finally:
        for each in first:
            each.close()


@pytest.mark.parametrize(
    ("wrong", "near"),
    [("My Game", "my-game"), ("Jeu d'été!", "jeu-d-ete"), ("RACING", "racing"), ("-x", "x")],
)
def test_wrong_name_of_a_profile_gets_a_name_that_can_be_used(wrong, near):
    with pytest.raises(ProfileError) as caught:
        find_own_path(wrong)
    assert caught.value.hint.startswith(f"Try: {near}. ")
    assert find_own_path(near).stem == near


@pytest.mark.parametrize("wrong", ["", "../x", "日本"])
def test_name_that_resembles_none_gets_the_rule_alone(wrong):
    with pytest.raises(ProfileError) as caught:
        find_own_path(wrong)
    assert caught.value.hint.startswith("A name has 1 to 64 letters from a to z")


def test_capital_letters_of_a_persons_name_are_no_riddle():
    with pytest.raises(WrongUsage) as caught:
        PlainName().convert("Ann", None, None)
    assert caught.value.hint.startswith("Try: ann. It becomes a part of a file's name: ")


def test_sim_without_a_scene_asks_for_one():
    with pytest.raises(SourceError, match=r"^'sim:' needs the name of a scene") as caught:
        find_scene("")
    assert "Scenes: tour, rest" in caught.value.hint


def test_capital_letters_of_a_scene_are_no_riddle():
    with pytest.raises(SourceError) as caught:
        find_scene("TOUR")
    assert caught.value.hint == "Did you mean sim:tour?"


def test_copilot_where_no_device_is_gets_a_fix_that_can_be_done(monkeypatch):
    monkeypatch.setattr(discovery, "find_inputs", list)
    with pytest.raises(DeviceError) as caught:
        discovery.find_copilot("auto")
    assert caught.value.hint == "Plug it in, then list what this machine sees: neurotouch devices"


def test_pause_says_in_one_sentence_how_to_go_on():
    assert "To continue: neurotouch resume." in (pause.help or "")


def test_widths_of_the_pointing_test_have_a_unit():
    block = dict.fromkeys(("effective_width_px", "effective_distance_px", "movement_s"), 19.0)
    block |= {"width_px": 80.0, "throughput_bit_s": 5.65, "error_rate": 0.0}
    result = {"simulated": True, "throughput_bit_s": 5.65, "movement_s": 1.0, "error_rate": 0.0}
    lines = _format({**result, "trials": 9, "blocks": [block]}, 9)
    assert "targets 80 pixels wide: 5.65 bit/s, effective width 19 pixels" in lines[-1]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("a: [1\n", "a '[' is opened"),
        ("[", "a value is missing before here"),
        ("a:\n  b: 1\n c: 2\n", "this line is indented otherwise"),
        ("a: b: c\n", "a ':' cannot be here"),
        ("a: %x\n", "a value cannot begin with this character"),
        ("a: 'x\n", "a quote is opened and never closed"),
        ('a: "\\q"\n', "no escape of YAML"),
    ],
)
def test_broken_yaml_is_explained_without_the_parsers_terms(text, sentence):
    _, (fault,) = parse_document(text)
    assert fault.sentence.startswith(sentence)
    assert fault.hint


def test_question_with_numbers_says_which_can_be_typed():
    asked = click.Command("ask", callback=lambda: choose("Which?", ["one", "two"]))
    told = CliRunner().invoke(asked, input="abc\n3\n2\n", standalone_mode=False)
    assert told.return_value == 1
    assert told.output.count("Error: Type a number from 1 to 2.") == 2


def test_enter_takes_the_choice_in_brackets():
    asked = click.Command("ask", callback=lambda: choose("Which?", ["one", "two"], default=1))
    told = CliRunner().invoke(asked, input="\n", standalone_mode=False)
    assert told.return_value == 1
    assert "Number [2]:" in told.output


@pytest.mark.parametrize(
    ("stamp", "told"),
    [
        ("2026-11-24 02-13-08", "2026-11-24 02:13:08"),
        ("2026-11-24 02-13-08 calibration", "2026-11-24 02:13:08 by a calibration"),
    ],
)
def test_times_of_versions_are_written_with_colons(stamp, told):
    assert _tell_time(stamp) == told


def test_script_of_gestures_proposes_the_near_word_in_a_sentence():
    with pytest.raises(ProfileError) as caught:
        parse_script("push lft 5mm")
    assert caught.value.hint == "Did you mean 'left'?"


def test_profile_without_layers_is_not_asked_to_choose_one():
    with pytest.raises(ProfileError) as caught:
        locate_bindings({"bindings": []}, "menu")
    assert caught.value.hint == "This profile has none: name no layer."


def test_status_without_a_driver_is_json_too_where_that_is_asked_for():
    told = CliRunner().invoke(cli, ["status", "--json"])
    assert told.exit_code == 8
    assert json.loads(told.output)["message"] == "No driver is running."


@pytest.fixture
def nothing_loads(monkeypatch):
    """A wrong command line is refused before the pipeline's libraries are even looked for."""
    monkeypatch.setitem(sys.modules, "neurotouch_hid.driver.driver", None)
    monkeypatch.setitem(sys.modules, "neurotouch_hid.cli.shared.play", None)


def refuse(command, *words):
    """Returns the error that a command ends with."""
    return CliRunner().invoke(command, words).exception


@pytest.mark.parametrize("command", [run, demo])
def test_second_driver_is_refused_before_anything_is_loaded(nothing_loads, command):
    with ControlSocket(find_runtime_folder(1)):
        error = refuse(command, *(["--source", "sim:tour"] if command is run else []))
    assert isinstance(error, AlreadyRunningError)
    assert error.message == f"The driver is already running (PID {os.getpid()})."
    assert error.hint == "Ask it: neurotouch status. End it: neurotouch stop"


@pytest.mark.parametrize("command", [run, demo])
def test_wrong_profile_is_refused_before_anything_is_loaded(nothing_loads, command):
    error = refuse(command, "--profile", "nosuch", *(["--source", "sim:tour"] * (command is run)))
    assert isinstance(error, ProfileError)


def test_wrong_copilot_is_refused_before_anything_is_loaded(nothing_loads):
    error = refuse(run, "--source", "sim:tour", "--device", "memory", "--copilot", "nosuch")
    assert isinstance(error, DeviceError)
    assert "'nosuch'" in error.message


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """A person with one profile of their own."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    assert CliRunner().invoke(new, ["mine", "--template", "spacecraft"]).exit_code == 0
    return tmp_path / "neurotouch" / "profiles" / "mine.yaml"


@pytest.mark.parametrize(
    ("words", "sentence", "fix"),
    [
        (
            ("filter", "strng"),
            "'filter' was not changed: 'strng' is not one of: none, light, medium, strong.",
            "Did you mean 'strong'?",
        ),
        (
            ("push.gain", "99"),
            "'push.gain' was not changed: 99 is too large, at most 5.",
            "What this means: neurotouch explain NT114",
        ),
        (
            ("push.gain", "much"),
            "'push.gain' was not changed: it needs a number, not 'much'.",
            "What this means: neurotouch explain NT113",
        ),
        (
            ("push.gain", "1,5"),
            "'push.gain' was not changed: it needs a number, not '1,5'.",
            "Write 1.5.",
        ),
        (
            ("pinch.on_mm", "4 mm"),
            "'pinch.on_mm' was not changed: it needs a number, not '4 mm'.",
            "Write 4.",
        ),
        (
            ("pinch.on_mm", "4 s"),
            "'pinch.on_mm' was not changed: it needs a number, not '4 s'.",
            "What this means: neurotouch explain NT113",
        ),
        (
            ("pinch.off_mm", "12"),
            "'pinch.off_mm' was not changed: off_mm (12 mm) must be below on_mm (2.5 mm), or the "
            "output would flicker.",
            "Set on_mm above 12 first, or off_mm below 2.5.",
        ),
        (
            ("name", "other"),
            "A profile is called as its file is, so 'name' was not changed.",
            "Make a copy: neurotouch profile new other --template mine",
        ),
        (("sound", "all"), "No such key: 'sound'.", None),
        (
            ("expo", "0.2"),
            "No such key: 'expo'.",
            "Did you mean 'push.curve.expo' or 'twist_cw.curve.expo' or 'twist_ccw.curve.expo'?",
        ),
    ],
)
def test_refused_value_is_explained_without_a_place_in_a_file(mine, words, sentence, fix):
    error = refuse(set_command, "mine", *words)
    assert error.message == sentence
    assert fix in (None, error.hint)


def test_refused_value_is_explained_in_json_too(mine):
    told = json.loads(CliRunner().invoke(set_command, ["mine", "filter", "x", "--json"]).output)
    assert told["message"].startswith("'filter' was not changed: 'x' is not one of: none, light")
    assert told["faults"][0]["line"]


@pytest.mark.parametrize(
    ("when", "do", "sentence", "fix"),
    [
        ("pinch jump", "button a", "'pinch jump' is not understood: 'jump'.", "After the gesture"),
        ("pinch", "jump", "'jump' is not understood.", "An action is stick, axis, trigger, "),
        ("pinch", "button", "'button' does not say which button.", "For example: button a."),
        ("pinch", "buton a", "'buton a' is not understood: 'buton'.", "Did you mean 'button'?"),
        (
            "pinch left",
            "button a",
            "'pinch left' was not bound to 'button a': only a push has a direction, ",
            "What this means: neurotouch explain NT121",
        ),
    ],
)
def test_refused_binding_names_what_can_be_written(mine, when, do, sentence, fix):
    error = refuse(bind, "mine", when, do)
    assert error.message.startswith(sentence)
    assert error.hint.startswith(fix)


@pytest.mark.parametrize("word", ["zoom, pinch", "zoom,pinch", "zoom pinch", "[zoom, pinch]"])
def test_list_may_be_written_without_brackets(mine, word):
    assert CliRunner().invoke(set_command, ["user", "unused", word]).exit_code == 0
    assert "unused: [zoom, pinch]" in mine.parents[1].joinpath("user.yaml").read_text()


def test_two_numbers_may_be_written_without_brackets(mine):
    assert CliRunner().invoke(set_command, ["mine", "zoom.range_mm", "1, 3.5"]).exit_code == 0
    assert "range_mm: [1, 3.5]" in mine.read_text()


def test_key_is_found_below_the_one_it_belongs_to(mine):
    error = refuse(set_command, "user", "sound", "all")
    assert error.hint == "Did you mean 'feedback.sound'?"


def test_key_of_a_part_that_is_not_there_yet_can_be_set(mine):
    assert CliRunner().invoke(bind, ["mine", "pinch tap", "key a"]).exit_code == 0
    done = CliRunner().invoke(set_command, ["mine", "pinch_tap.repeat.delay_ms", "500"])
    assert done.exit_code == 0
    assert "repeat: {delay_ms: 500}" in mine.read_text()


def test_unknown_profile_is_told_the_command_that_lists_them():
    assert refuse(show, "qqqq").hint == "List them: neurotouch profile list"
    assert refuse(show, "racin").hint == "Did you mean 'racing'?"


def test_unknown_code_is_told_the_command_that_lists_them():
    assert refuse(explain, "NT999").hint == "List them: neurotouch explain"
    assert refuse(explain, "112").hint == "Did you mean 'NT112'?"


@pytest.fixture
def running(monkeypatch):
    """What a driver says that plays."""
    words = {"source": "sim:tour", "device": "memory", "settings": "this user's own"}
    words |= {"keyboard": "none", "desktop": "none", "sound": "none"}
    words |= {"state": "running", "profile": "racing", "layer": "base", "gesture": "none"}
    numbers = dict.fromkeys(("pid", "silent_s", "uptime_s", "slices", "slices_hz"), 0)
    numbers |= {"markers_tracked": 177, "events_hz": 9, "events_lost": 0, "version": 1}
    numbers |= {"simulated": True}
    times = {"stage_ms": {"tracker": 1.0}}
    times["stage_spread_ms"] = {"tracker": {"p50": 1.0, "p99": 2.0, "p99.9": 3.0}}
    found = GelState(is_found=True, was_found=True, problem=GelProblem.NONE, px_per_mm=2.5)
    more = {
        "gel": report_gel(found),
        "fatigue": [],
        "long_holds": {},
        "errors": [],
        "ignored": None,
    }
    monkeypatch.setattr(client, "ask_status", lambda: {**words, **numbers, **times, **more})


def test_status_begins_with_what_concerns_a_person(running):
    lines = CliRunner().invoke(status).output.splitlines()
    assert lines[:5] == [
        "OK: running",
        "profile: racing",
        "layer: base",
        "source: SIMULATED sim:tour",
        "pad: memory",
    ]
    assert "gel: found, 177 of 177 markers tracked" in lines
    assert not any("p99" in line or "ms a slice" in line for line in lines)


def test_times_of_the_stages_are_told_when_asked_for(running):
    lines = CliRunner().invoke(status, ["--verbose"]).output.splitlines()
    assert lines[0] == "OK: running"
    assert lines[-1] == "since the start, tracker: p50 1.000, p99 2.000, p99.9 3.000 ms"
    assert json.loads(CliRunner().invoke(status, ["--json"]).output)["stage_spread_ms"]


def test_list_of_profiles_begins_with_their_names(mine):
    names = [line.split(",")[0] for line in CliRunner().invoke(list_command).output.splitlines()]
    assert names[0] == "default"
    assert "mine" in names
    mine.write_text("version: 1\n")
    assert "FAILED mine, yours: it has errors" in CliRunner().invoke(list_command).output


def test_who_has_no_keyboard_is_told_so(monkeypatch):
    read, write = os.pipe()
    os.close(write)
    with os.fdopen(read) as nothing:
        monkeypatch.setattr(sys, "stdin", nothing)
        keyboard = Keyboard()
        with pytest.raises(NeuroTouchError, match="The input has ended, so no more"):
            keyboard.poll()


def test_deleted_profile_is_gone_until_that_is_undone(mine):
    text = mine.read_text()
    assert CliRunner().invoke(delete, ["mine"]).output.splitlines() == [
        "OK Deleted 'mine'.",
        "Back: neurotouch profile undo mine",
    ]
    assert not mine.exists()
    assert refuse(show, "mine").message == "No profile is called 'mine'."
    told = CliRunner().invoke(undo, ["mine"]).output
    assert told.startswith("OK mine is back, as in version 1.\n")
    assert mine.read_text() == text


def test_copy_of_a_shipped_profile_is_deleted_and_the_shipped_one_is_back(mine):
    assert CliRunner().invoke(set_command, ["racing", "description", "Mine"]).exit_code == 0
    assert CliRunner().invoke(use, ["racing"]).exit_code == 0
    told = CliRunner().invoke(delete, ["racing"]).output
    assert "OK Deleted 'racing'.\nThe profile 'racing' is now: " in told
    assert "Twist to steer" in CliRunner().invoke(show, ["racing"]).output


@pytest.mark.parametrize(
    ("name", "sentence", "fix"),
    [
        ("racing", "'racing' is not your own profile, so it is never deleted.", "See which are"),
        ("user", "'user' is what your own values are called, and no profile.", "Go back to the"),
        ("qqqq", "No profile is called 'qqqq'.", "List them: neurotouch profile list"),
    ],
)
def test_profile_that_is_not_ones_own_stays(mine, name, sentence, fix):
    error = refuse(delete, name)
    assert error.message == sentence
    assert error.hint.startswith(fix)


def test_profile_that_is_needed_stays_and_the_fix_works(mine):
    other = mine.with_name("other.yaml")
    for words in ((new, "other"), (set_command, "other", "extends", "mine"), (use, "mine")):
        assert CliRunner().invoke(words[0], words[1:]).exit_code == 0
    error = refuse(delete, "mine")
    assert error.message == "'mine' is the active profile."
    assert error.hint.endswith("favourites: neurotouch profile set user slots default")
    CliRunner().invoke(use, ["default"])
    error = refuse(delete, "mine")
    assert error.message == "'mine' is among the favourites."
    assert error.hint == "Take it out: neurotouch profile set user slots default"
    CliRunner().invoke(set_command, ["user", "slots", "default"])
    error = refuse(delete, "mine")
    assert error.message == "Your profile 'other' is built on 'mine'."
    assert error.hint == "Delete that one first: neurotouch profile delete other"
    for name in ("other", "mine"):
        assert CliRunner().invoke(delete, [name]).exit_code == 0
    assert not other.exists()
    assert not mine.exists()
