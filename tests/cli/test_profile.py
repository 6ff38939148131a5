"""``neurotouch profile`` as people use it, with wrong input too."""

import errno
import json
import signal
import subprocess
import sys

import click
import pytest
from click.testing import CliRunner
from ruamel.yaml import YAML

from neurotouch_hid.cli.main import cli
from neurotouch_hid.cli.profile import drafts, saving
from neurotouch_hid.errors import NeuroTouchError, ProfileError
from neurotouch_hid.profile.reading.library import find_shipped_folder
from tests.processes import run_command, run_neurotouch, start_neurotouch
from tests.waiting import LIMIT_S


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    return tmp_path / "neurotouch"


def run(*arguments, answers=None):
    """Output and exit code of a command; answers are typed one a line."""
    text = None if answers is None else "".join(f"{answer}\n" for answer in answers)
    result = CliRunner().invoke(cli, [str(a) for a in arguments], input=text)
    error = result.exception
    if isinstance(error, NeuroTouchError):
        return f"{result.output}{error.message}\n{error.hint or ''}", error.exit_code
    if error is not None and not isinstance(error, SystemExit | click.Abort):
        raise error
    return result.output, result.exit_code


def own(home, name):
    return (home / "profiles" / f"{name}.yaml").read_text(encoding="utf-8")


def test_a_shipped_profile_is_copied_changed_and_undone(home):
    output, code = run("profile", "set", "racing", "twist.gain", "1.5")
    assert code == 0
    assert " added: " in output
    assert "your own copy" in output
    shipped = (find_shipped_folder() / "racing.yaml").read_text(encoding="utf-8")
    changed = set(own(home, "racing").splitlines()) - set(shipped.splitlines())
    assert len(changed) == 2  # the schema line and the value
    assert "gain: 1.5" in own(home, "racing")
    output, _ = run("profile", "diff", "racing")
    assert output.count(" added: ") == 1
    output, _ = run("profile", "history", "racing")
    assert output.startswith("version 1: replaced ")
    assert run("profile", "undo", "racing")[1] == 0
    assert "gain: 1.5" not in own(home, "racing")
    assert run("profile", "undo", "racing")[1] == 6
    output, code = run("profile", "undo", "racing", "--to", "2")
    assert code == 0
    assert "gain: 1.5" in own(home, "racing")


def test_what_is_wrong_is_refused_with_its_place_and_nothing_changes(home):
    for arguments, words in (
        (("set", "racing", "twist.gain", "99"), "too large, at most 5"),
        (("set", "racing", "twist.gian", "1"), "Did you mean 'twist.gain'?"),
        (("set", "raceing", "twist.gain", "1"), "Did you mean 'racing'?"),
        (("bind", "racing", "pinch", "button q"), "is not one of: a, b"),
        (("bind", "racing", "pnch", "button a"), "Did you mean 'pinch'?"),
        (("bind", "racing", "pinch", "layer menu"), "there is no layer 'menu'"),
        (("unbind", "racing", "zoom hold"), "There is no such binding"),
        (("new", "../racing"), "cannot be called"),
        (("show", "nope"), "No profile is called"),
        (("import", "nope.yaml"), "cannot be read"),
        (("import", "/"), "it is a folder, not a file"),
        (("export", "nope"), "No profile is called"),
    ):
        output, code = run("profile", *arguments)
        assert code == 6, arguments
        assert words in output, output
    assert not (home / "profiles").exists()


def test_a_key_that_changes_the_name_of_its_binding_can_be_set(home):
    run("profile", "new", "mine", "--template", "spacecraft")
    run("profile", "bind", "mine", "twist cw", "button x")
    output, code = run("profile", "set", "mine", "twist_cw.press", "tap")
    assert (code, "No such key" in output) == (0, False), output
    assert "{gesture: twist_cw, press: tap}" in own(home, "mine")


def test_setting_a_value_parses_the_old_and_the_new_text_once(home, monkeypatch):
    run("profile", "new", "mine", "--template", "racing")
    before, parsed = own(home, "mine"), []
    for name in ("parse", "compose"):
        real = getattr(YAML, name)
        monkeypatch.setattr(
            YAML, name, lambda self, text, real=real: (parsed.append(text), real(self, text))[1]
        )
    assert run("profile", "set", "mine", "description", "Mine.")[1] == 0
    after = own(home, "mine")
    assert [parsed.count(text) for text in (before, after)] == [2, 1]  # values and places; values


def test_binding_and_unbinding_in_words(home):
    run("profile", "new", "mine", "--template", "spacecraft")
    output, code = run("profile", "bind", "mine", "pinch hold", "toggle button a")
    assert code == 0
    assert "added: - when: {gesture: pinch, press: hold}" in output
    output, _ = run("profile", "show", "mine")
    assert "pinch hold -> toggle button a" in output
    assert run("profile", "unbind", "mine", "pinch hold")[1] == 0
    assert "pinch hold" not in run("profile", "show", "mine")[0]
    output, code = run("profile", "bind", "mine", "pinch double", "button x")
    assert "The same gesture also does: " in output
    output, _ = run("profile", "set", "mine", "pinch_double.on", "4")
    assert "Did you mean 'pinch_double.on_mm'?" in output
    assert run("profile", "set", "mine", "push.gain", "--default")[1] == 0  # it applies already
    assert run("profile", "set", "mine", "push.gain")[1] == 2


def test_a_warning_that_was_there_before_is_counted_and_not_told_again(home):
    (home / "profiles").mkdir(parents=True)
    pinch = "bindings:\n  - {when: {gesture: pinch, on_mm: 3}, do: {button: a}}\n"
    (home / "profiles/mine.yaml").write_text(f"version: 1\nname: mine\n{pinch}", encoding="utf-8")
    output, _ = run("profile", "set", "mine", "pinch.off_mm", "2.5")
    assert "WARNING" in output
    output, _ = run("profile", "set", "mine", "description", "Mine.")
    assert "WARNING" not in output
    assert "1 older warning stays: neurotouch profile check mine" in output
    output, _ = run("profile", "check", "mine")
    assert "WARNING" in output
    output, _ = run("profile", "set", "mine", "description", "Still mine.", "--json")
    assert [each["severity"] for each in json.loads(output)["faults"]] == ["warning"]


def test_a_profile_that_begins_as_the_persons_own_copy_says_so(home):
    output, _ = run("profile", "new", "mine")
    assert "It begins as" not in output
    run("profile", "set", "default", "description", "Mine.")
    output, _ = run("profile", "new", "other")
    assert "It begins as your own 'default' is now." in output


def test_check_finds_all_and_says_how_bad_it_is(home, tmp_path):
    output, code = run("profile", "check")
    assert code == 0
    assert all(line.startswith(("OK ", "WARNING ", "Fix: ")) for line in output.splitlines())
    bad = tmp_path / "bad.yaml"
    bad.write_text(
        "version: 1\nname: bad\nbindings:\n  - when: pusch\n    do: {button: q}\n", encoding="utf-8"
    )
    output, code = run("profile", "check", bad, "racing", "nope")
    assert code == 6
    assert f"FAILED {bad}:4:11: bindings[0].when: 'pusch' is not one of" in output
    assert "Fix: did you mean 'push'?" in output
    assert "FAILED 3 errors" in output
    output, code = run("profile", "check", bad, "--json")
    assert code == 6
    first, second = json.loads(output)
    assert (first["line"], first["col"], first["end"]) == (4, 11, 16)
    assert (first["code"], first["severity"]) == ("NT112", "error")
    assert first["fix"] == "did you mean 'push'?"
    assert second["line"] == 5
    risky = tmp_path / "risky.yaml"
    risky.write_text(
        "version: 1\nname: risky\nbindings:\n"
        "  - when: {gesture: pinch, contacts: 2}\n    do: {button: a}\n",
        encoding="utf-8",
    )
    output, code = run("profile", "check", risky)
    assert code == 0
    assert output.startswith("WARNING ")
    (home / "user.yaml").parent.mkdir(exist_ok=True)
    (home / "user.yaml").write_text("version: 1\nfilter: mad\n", encoding="utf-8")
    assert run("profile", "check")[1] == 6


def test_lists_are_for_people_and_programs(home):
    run("profile", "new", "mine")
    output, _ = run("profile", "list")
    assert "\nmine, yours: " in output
    rows = json.loads(run("profile", "list", "--json")[0])
    assert {"name", "path", "own", "status", "in_use", "description"} == set(rows[0])
    shown = json.loads(run("profile", "show", "mine", "--effective", "--json")[0])
    assert shown["profile"]["name"] == "mine"
    assert shown["user"]["handedness"] == "right"
    output, _ = run("profile", "show", "push-only", "--effective")
    assert "hold_ms: 700" in output


def test_a_profile_that_cannot_be_read_leaves_the_others_in_the_list(home):
    run("profile", "new", "mine")
    (home / "profiles" / "closed.yaml").symlink_to("/proc/self/mem")  # nobody can read this
    output, code = run("profile", "list")
    assert code == 0
    assert "FAILED closed, yours: it has errors, see: neurotouch profile check closed\n" in output
    assert "\nmine, yours: " in output
    output, code = run("profile", "check", "closed")
    assert code == 6
    assert "closed.yaml cannot be read: Input/output error.\n" in output


def test_use_makes_a_favourite_and_keeps_no_version(home):
    assert run("profile", "use", "racing")[1] == 0
    output, code = run("profile", "use", "mouse")
    assert code == 0
    assert "No driver is running" in output
    text = (home / "user.yaml").read_text(encoding="utf-8")
    assert "slots: [mouse, racing, default]" in text
    assert "\nmouse, shipped, in use" in run("profile", "list")[0]
    assert run("profile", "use", "nope")[1] == 6
    (home / "elsewhere.yaml").write_text(
        "version: 1\nname: e\nextends: [mouse]\n", encoding="utf-8"
    )
    output, code = run("profile", "use", home / "elsewhere.yaml")
    assert code == 6
    assert "profile import" in output


def test_what_is_exported_has_nothing_of_the_person(home, tmp_path):
    run("profile", "use", "racing")
    run("profile", "new", "mine", "--template", "racing")
    output, code = run("profile", "export", "mine")
    assert code == 0
    first, rest = own(home, "mine").split("\n", 1)
    assert "/" in first  # the way to the schema on this machine
    assert output == f"# yaml-language-server: $schema=profile-1.json\n{rest}"
    assert run("profile", "export", "mine", "--output", "-") == (output, 0)
    path, user = tmp_path / "out.yaml", tmp_path / "me.yaml"
    assert run("profile", "export", "mine", "--output", path)[1] == 0
    assert path.read_text(encoding="utf-8") == output
    assert not user.exists()
    assert run("profile", "export", "mine", "--output", path)[1] == 6
    assert run("profile", "export", "mine", "--output", path, "--force", "--user", user)[1] == 0
    assert "slots" in user.read_text(encoding="utf-8")
    assert "/" not in user.read_text(encoding="utf-8").split("\n", 1)[0]
    other = tmp_path / "other.yaml"
    assert run("profile", "export", "mine", "--output", other, "--user", user)[1] == 6
    assert not other.exists()  # nothing is written where a part is refused


def test_an_import_shows_what_it_does_and_asks(home, tmp_path):
    file = tmp_path / "friend.yaml"
    text = "version: 1\nname: friend\nbindings:\n  - when: push\n    do: {stick: left}\n"
    file.write_text(text, encoding="utf-8")
    output, code = run("profile", "import", file, answers=["n"])
    assert code == 0
    assert "push -> stick left" in output
    assert not (home / "profiles").exists()
    assert run("profile", "import", file, answers=["y"])[1] == 0
    assert own(home, "friend") == text
    file.write_text(text.replace("left", "right"), encoding="utf-8")
    output, _ = run("profile", "import", file, "--yes")
    assert "line 5 added: do: {stick: right}" in output
    assert run("profile", "diff", "friend", "--last")[0].count("added") == 1
    output, _ = run("profile", "import", file, "--name", "racing", "--yes")
    assert "hide the shipped profile" in output
    assert "name: racing" in own(home, "racing")
    for name in ("../x", "/tmp/x", "x/y", "X"):
        assert run("profile", "import", file, "--name", name, "--yes")[1] == 6
    file.write_text(text.replace("name: friend", "name: ../../x"), encoding="utf-8")
    assert run("profile", "import", file, "--yes")[1] == 6
    file.write_bytes(b"a" * 70_000)
    assert run("profile", "import", file, "--yes")[1] == 6


OUTCOME = {"status", "message", "file", "changed", "lines", "faults", "notes", "fix"}


def test_every_change_has_the_same_shape_for_programs(home, tmp_path):
    other = tmp_path / "other.yaml"
    for command in (
        ("new", "mine"),
        ("set", "mine", "push.gain", "1.5"),
        ("bind", "mine", "pinch hold", "button x"),
        ("unbind", "mine", "pinch hold"),
        ("undo", "mine"),
        ("upgrade", "mine"),
        ("use", "mine"),
        ("import", other, "--yes"),
    ):
        other.write_text(
            own(home, "mine").replace("name: mine", "name: b") if home.exists() else ""
        )
        output, code = run("profile", *command, "--json")
        told = json.loads(output)
        assert code == 0
        assert set(told) == OUTCOME
        assert told["status"] == "OK"
        assert told["changed"] is (command[0] != "upgrade")
    assert own(home, "b")
    refused = json.loads(run("profile", "set", "mine", "push.gain", "99", "--json")[0])
    assert set(refused) == OUTCOME
    assert refused["status"] == "FAILED"
    assert refused["faults"][0]["code"] == "NT114"
    output, code = run("profile", "set", "mine", "x.y", "1", "--json")
    assert code == 6
    assert json.loads(output)["status"] == "FAILED"
    asked = json.loads(run("profile", "import", other, "--name", "c", "--json")[0])
    assert asked["changed"] is False
    assert len(asked["lines"]) > 10
    assert not (home / "profiles" / "c.yaml").exists()


def test_a_device_that_a_profile_is_exported_to_stays_one(home, tmp_path):
    nowhere = tmp_path / "nowhere"
    nowhere.symlink_to("/dev/null")
    assert run("profile", "export", "racing", "--output", nowhere, "--force")[1] == 0
    assert nowhere.is_char_device()


def test_a_persons_values_come_back_from_what_was_exported(home, tmp_path):
    mine = "version: 1\nfilter: strong\nunused: [zoom]\n"
    home.mkdir()
    (home / "user.yaml").write_text(mine, encoding="utf-8")
    assert (
        run(
            "profile",
            "export",
            "racing",
            "--output",
            tmp_path / "r.yaml",
            "--user",
            tmp_path / "me.yaml",
        )[1]
        == 0
    )
    (home / "user.yaml").write_text("version: 1\n", encoding="utf-8")
    output, _ = run("profile", "import", "--user", tmp_path / "me.yaml", answers=["n"])
    assert "added: unused: [zoom]" in output
    assert "Nothing was saved" in output
    assert run("profile", "import", "--user", tmp_path / "me.yaml", answers=["y"])[1] == 0
    assert (home / "user.yaml").read_text(encoding="utf-8") == mine
    assert run("profile", "import", "--user", tmp_path / "r.yaml", "--yes")[1] == 6
    assert run("profile", "import", tmp_path / "me.yaml", "--yes")[1] == 6
    assert run("profile", "undo", "user")[1] == 0
    assert (home / "user.yaml").read_text(encoding="utf-8") == "version: 1\n"


def test_a_new_profile_asks_for_nothing_one_cannot_do(home):
    home.mkdir()
    (home / "user.yaml").write_text("version: 1\nunused: [zoom]\n", encoding="utf-8")
    assert "you do not use zoom: this never acts [NT212]" in run("profile", "check", "default")[0]
    output, code = run("profile", "new", "mine")
    assert code == 0
    assert "For you: pinch double -> button b\n" in output
    assert "[NT" not in run("profile", "check", "mine")[0]
    assert "you do not use: zoom" in run("profile", "show", "mine", "--effective")[0]


def test_an_upgrade_adds_the_version_and_the_schema_line(home):
    (home / "profiles").mkdir(parents=True)
    old = "name: old\nbindings:\n  - when: push\n    do: {stick: left}\n"
    (home / "profiles" / "old.yaml").write_text(old, encoding="utf-8")
    assert run("profile", "upgrade", "old")[1] == 0
    assert own(home, "old").splitlines()[1:] == ["version: 1", *old.splitlines()]
    assert "current version" in run("profile", "upgrade", "old")[0]


PROFILE = """\
version: 1
name: golden
bindings:
  - when: push
    do: {stick: left, range_mm: [1.0, 6.0]}
  - when: pinch
    do: {button: a}
  - when: {gesture: zoom, press: hold}
    do: {key: ctrl+c, mode: toggle}
"""
SCRIPT = "push left 5mm 300ms hold 500ms; rest 500ms; pinch 6mm 100ms; rest 500ms; zoom 5mm hold 1s"
TIMELINE = """\
   0.000 s  rest
   0.050 s  push left
   0.130 s  left_x -25 %
   0.180 s  left_x -50 %
   0.230 s  left_x -75 %
   0.910 s  left_x -50 %
   0.950 s  left_x -25 %
   1.010 s  left_x +0 %
   1.060 s  rest
   1.620 s  pinch
   1.660 s  button a down
   1.880 s  button a up
   1.890 s  rest
   2.430 s  zoom
   2.840 s  key c down; key leftctrl down
   3.680 s  rest
"""


def test_scripted_gestures_give_a_timeline(tmp_path):
    path, moves = tmp_path / "golden.yaml", tmp_path / "moves.txt"
    path.write_text(PROFILE, encoding="utf-8")
    moves.write_text(SCRIPT.replace("; ", "\n"), encoding="utf-8")
    output, code = run("profile", "test", path, "--script", SCRIPT)
    assert code == 0
    assert output == TIMELINE
    assert run("profile", "test", path, "--file", moves)[0] == TIMELINE
    moments = json.loads(run("profile", "test", path, "--script", SCRIPT, "--json")[0])
    assert moments[1] == {"t_us": 50_000, "gesture": "push left", "changes": []}
    assert len(moments) == len(TIMELINE.splitlines())
    assert run("profile", "test", "racing", "--script", "jump 3mm")[1] == 6
    assert "trigger" in run("profile", "test", "racing")[0]


def test_questions_and_answers_change_a_profile(home):
    answers = [5, 3, 4, 2.0, 1, 9, 1]
    output, code = run("profile", "edit", "spacecraft", answers=answers)
    assert code == 0, output
    assert "percent" in output
    assert "gain: 2.0" in own(home, "spacecraft")
    output, code = run("profile", "edit", "spacecraft", answers=[5, 3, 4, 99, 9])
    assert code == 0
    assert "That does not fit" in output
    assert "Nothing has changed." in output


def test_a_new_binding_by_questions(home):
    answers = [6, 2, 2, 1, 2, 1, 10, 1]
    output, code = run("profile", "edit", "spacecraft", answers=answers)
    assert code == 0, output
    assert "when: {gesture: push, direction: left, press: tap}" in own(home, "spacecraft")
    assert "do: {button: b}" in own(home, "spacecraft")


def test_every_question_can_be_taken_back(home):
    """Back leads to the question before, from the first one to the list of bindings."""
    when = [6, 10, 6, 2, 6, 2, 1]  # gesture and back; gesture, how and back; both
    do = [9, 2, 1, 1, 12, 6, "", 9, 10]  # what and back; gesture again; a button and back; a key
    adjust = [5, 3, 4, ""]
    output, code = run("profile", "edit", "spacecraft", answers=[*when, *do, *adjust, 9])
    assert code == 0, output
    assert "Nothing has changed." in output
    for question in ("Which gesture?", "How?", "What should it do?", "Which one?", "Key, or"):
        assert question in output
    outputs = output.split("Number")
    asks = [text for text in outputs if "\n  1. " in text and "Done" not in text]
    assert asks
    assert all("Back" in text or "Keep it" in text for text in asks), asks


def test_a_value_of_a_person_can_be_taken_back(home):
    output, code = run("profile", "edit", "user", answers=[2, 6, 5, "", 9])
    assert code == 0, output
    assert "Nothing has changed" in output


def test_when_the_answers_end_the_draft_is_kept(home):
    output, code = run("profile", "edit", "spacecraft", answers=[5, 3, 4, 2.0, 1])
    assert code == 1
    assert "draft" in output
    assert not (home / "profiles" / "spacecraft.yaml").exists()
    output, code = run("profile", "edit", "spacecraft", answers=[1, 9, 1])
    assert code == 0
    assert "gain: 2.0" in own(home, "spacecraft")
    assert not (home / "profiles" / ".drafts" / "spacecraft.yaml").exists()


def test_a_change_can_be_tried_on_the_gel_before_it_is_kept(home):
    # push, adjust, gain 2, try it, keep it, done, save
    answers = [1, 3, 4, 2.0, 3, 1, 9, 1]
    output, code = run(
        "profile", "edit", "spacecraft", "--source", "sim:push-left", answers=answers
    )
    assert code == 0
    moving = [line for line in output.splitlines() if line.startswith("push left")]
    assert any("left stick left 100 %" in line for line in moving)
    assert "neutral" in moving[0] + moving[-1]
    assert len(moving) > 5


def test_the_text_editor_loses_nothing(home, tmp_path, monkeypatch):
    editor = tmp_path / "editor"
    editor.write_text('#!/bin/sh\nsed -i "s/stick: left/stick: middle/" "$1"\n', encoding="utf-8")
    editor.chmod(0o755)
    monkeypatch.setenv("VISUAL", str(editor))
    output, code = run("profile", "edit", "spacecraft", "--editor", answers=[3])
    assert code == 0
    assert "'middle' is not one of: left, right" in output
    draft = home / "profiles" / ".drafts" / "spacecraft.yaml"
    assert "stick: middle" in draft.read_text(encoding="utf-8")
    assert not (home / "profiles" / "spacecraft.yaml").exists()
    assert run("profile", "edit", "spacecraft", answers=[1])[1] == 6  # the draft is wrong
    assert draft.exists()
    editor.write_text('#!/bin/sh\nsed -i "s/stick: middle/stick: right/" "$1"\n', encoding="utf-8")
    assert run("profile", "edit", "spacecraft", "--editor", answers=[1])[1] == 0
    assert "stick: right" in own(home, "spacecraft")
    assert not draft.exists()


EDITOR = """\
#!/bin/sh
sed -i "s/stick: left/stick: right/" "$1"
printf "\\n# by hand\\n" >> "$XDG_CONFIG_HOME/neurotouch/profiles/mine.yaml"
"""


def test_what_was_typed_is_kept_when_the_file_has_changed_meanwhile(home, tmp_path, monkeypatch):
    run("profile", "new", "mine")
    editor = tmp_path / "editor"
    editor.write_text(EDITOR, encoding="utf-8")
    editor.chmod(0o755)
    monkeypatch.setenv("VISUAL", str(editor))
    output, code = run("profile", "edit", "mine", "--editor")
    assert code == 6
    assert "was changed by another program meanwhile" in output
    assert "stick: right" in (home / "profiles/.drafts/mine.yaml").read_text(encoding="utf-8")
    assert "stick: left" in own(home, "mine")


@pytest.mark.parametrize("editor", ["/nonexistent/editor", "false", "it's"])
def test_an_editor_that_fails_is_named(monkeypatch, editor):
    monkeypatch.setenv("VISUAL", editor)
    output, code = run("profile", "edit", "racing", "--editor")
    assert code == 1
    assert "The text editor has failed" in output
    assert "neurotouch profile edit racing" in output


@pytest.mark.parametrize("end", ["exit 1", "kill -9 $$", "kill -HUP $PPID; sleep 1"])
def test_what_the_editor_has_saved_stays_if_it_ends_badly(home, tmp_path, monkeypatch, end):
    editor = tmp_path / "editor"
    editor.write_text(f'#!/bin/sh\n[ "$QUIET" ] || echo "# mine" >> "$1"\n{end}\n')
    editor.chmod(0o755)
    monkeypatch.setenv("VISUAL", str(editor))
    draft = home / "profiles" / ".drafts" / "spacecraft.yaml"
    code = 130 if "HUP" in end else 1
    done = run_neurotouch("profile", "edit", "spacecraft", "--editor", code=code)
    assert f"Not saved; the draft is in {draft}" in done.stdout
    assert draft.read_text(encoding="utf-8").endswith("# mine\n")
    draft.unlink()
    monkeypatch.setenv("QUIET", "yes")
    run_neurotouch("profile", "edit", "spacecraft", "--editor", code=code)
    assert not draft.exists()


def test_a_draft_for_which_the_disk_has_no_room_is_named(home, monkeypatch):
    def fill(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    run("profile", "new", "mine")
    monkeypatch.setattr(drafts, "write_whole", fill)
    monkeypatch.setattr(saving, "save_edited", refuse)
    output, code = run("profile", "edit", "mine", answers=[11, 1, 1, 13, 1])
    assert code == 1
    assert f"'{home / 'profiles/.drafts/mine.yaml'}' cannot be written" in output
    assert "Make room on this disk" in output


@pytest.mark.parametrize("answers", [[11, 1, 1, 13], [11, 1, 1, 13, 1]])
def test_a_change_that_cannot_be_saved_is_kept_as_a_draft(home, monkeypatch, answers):
    run("profile", "new", "mine")
    if len(answers) > 4:
        monkeypatch.setattr(saving, "save_edited", refuse)
    assert run("profile", "edit", "mine", answers=answers)[1] != 0
    assert "timing: game" in (home / "profiles/.drafts/mine.yaml").read_text(encoding="utf-8")


def test_own_values_that_were_not_saved_are_kept_as_a_draft(home):
    assert run("profile", "edit", "user", answers=[1, 1, 9])[1] == 1
    assert "timing: game" in (home / ".drafts/user.yaml").read_text(encoding="utf-8")
    assert run("profile", "edit", "user", answers=[1, 9, 1])[1] == 0
    assert "timing: game" in (home / "user.yaml").read_text(encoding="utf-8")
    assert not (home / ".drafts/user.yaml").exists()


def test_closing_the_terminal_keeps_what_was_not_saved_as_a_draft(home):
    run("profile", "new", "mine")
    process = start_neurotouch("profile", "edit", "mine", stdin=subprocess.PIPE)
    process.stdin.write("11\n1\n1\n")
    process.stdin.flush()
    assert any("Timing: game" in line for line in process.stdout)
    process.send_signal(signal.SIGHUP)
    process.communicate(timeout=LIMIT_S)
    assert process.returncode == 130
    assert "timing: game" in (home / "profiles/.drafts/mine.yaml").read_text(encoding="utf-8")


def refuse(*_, **__):
    raise ProfileError("It was changed by another program meanwhile.")


@pytest.mark.parametrize("columns", [20, 32, 80])
def test_a_list_can_be_read_on_a_narrow_terminal(monkeypatch, columns):
    monkeypatch.setattr("neurotouch_hid.cli.ui.output.is_plain", lambda **_: False)
    monkeypatch.setenv("COLUMNS", str(columns))
    lines = run("profile", "list")[0].splitlines()
    assert max(map(len, lines)) <= columns
    assert any("controller" in line for line in lines)


def test_codes_are_explained():
    assert run("explain", "nt203")[0].startswith("NT203: ")
    assert len(run("explain")[0].splitlines()) > 30
    assert json.loads(run("explain", "NT101", "--json")[0])[0]["code"] == "NT101"
    assert run("explain", "NT999")[1] == 6


@pytest.mark.parametrize("what", ["profile", "user"])
def test_the_printed_schema_is_the_shipped_one(what):
    shipped = find_shipped_folder() / "schema" / f"{what}-1.json"
    assert json.loads(run("schema", what)[0]) == json.loads(shipped.read_text(encoding="utf-8"))
    line, _ = run("schema", what, "--line")
    assert line.strip().endswith(f"{what}-1.json")


def complete(*words):
    """What a shell offers for the last word."""
    from click.shell_completion import ShellComplete

    offers = ShellComplete(cli, {}, "neurotouch", "_NEUROTOUCH_COMPLETE").get_completions(
        list(words[:-1]), words[-1]
    )
    return [offer.value for offer in offers]


def test_the_shell_completes_names_keys_and_codes():
    assert complete("profile", "show", "ra") == ["racing"]
    assert "twist.curve" in complete("profile", "set", "racing", "twist.c")
    assert complete("profile", "set", "nope", "t") == []
    assert complete("explain", "nt20")[0] == "NT201"
    assert "calibrate" in complete("cal")
    for command in ("run", "demo"):
        assert complete(command, "--profile", "ra") == ["racing", "ra"]  # or a file
    assert complete("demo", "--scene", "push-l") == ["push-left"]


def test_output_in_a_pipe_is_plain_and_errors_have_their_code(home):
    done = run_neurotouch("profile", "set", "racing", "x.y", "1", code=6)
    assert done.stderr.startswith("Error: No such key: 'x.y'.\nFix: ")
    assert "Traceback" not in done.stderr
    assert "\x1b" not in done.stdout + done.stderr


@pytest.mark.parametrize(
    ("arguments", "absent"),
    [
        (("profile", "--help"), ("numpy", "pydantic", "ruamel")),
        (("explain", "NT203"), ("numpy", "pydantic", "ruamel")),
        (("profile", "check"), ("numpy", "numba", "cv2")),
        (("profile", "set", "racing", "twist.gain", "1.5"), ("numpy", "numba", "cv2")),
    ],
)
def test_a_command_imports_no_more_than_it_needs(arguments, absent):
    code = (
        "import sys; from neurotouch_hid.cli.main import cli\n"
        f"cli.main({list(arguments)!r}, standalone_mode=False)\n"
        f"print([name for name in {absent!r} if name in sys.modules])"
    )
    done = run_command(sys.executable, "-c", code)
    assert done.stdout.splitlines()[-1] == "[]"


def test_the_names_of_profiles_need_no_models():
    code = (
        "import sys; from neurotouch_hid.profile import list_profiles; list_profiles()\n"
        "print('pydantic' in sys.modules)"
    )
    done = run_command(sys.executable, "-c", code)
    assert done.stdout == "False\n"


def test_filters_are_told_beside_their_design_and_the_cost_of_a_profile():
    figures = json.loads(run("bench", "profile", "--json")[0])
    assert {"light", "medium", "strong"} < set(figures["filters"])
    assert figures["engine_ms"]["bindings"] == 60
    output, code = run("bench", "profile")
    assert code == 0
    assert "medium leaves of a tremor 3" in output
    assert "(28) % at 5 Hz" in output


def test_what_is_for_all_on_the_machine_is_not_called_ones_own(home, tmp_path, monkeypatch):
    machine = tmp_path / "machine"
    (machine / "profiles").mkdir(parents=True)
    monkeypatch.setenv("CONFIGURATION_DIRECTORY", str(machine))
    words = "version: 1\nname: room\nbindings: [{when: pinch, do: {button: a}}]\n"
    (machine / "profiles/room.yaml").write_text(words)
    (machine / "user.yaml").write_text("version: 1\nfilter: strong\n")
    run("profile", "new", "mine")
    assert "room, for all: " in run("profile", "list")[0]
    own = {row["name"] for row in json.loads(run("profile", "list", "--json")[0]) if row["own"]}
    assert own == {"mine"}
    output, _ = run("profile", "set", "room", "pinch.on_mm", "4")
    assert "This is your own copy; the original stays as it is." in output
    assert "room, yours: " in run("profile", "list")[0]
    output, _ = run("profile", "show", "user")
    assert f"not there yet\nuntil then, the machine's: {machine}/user.yaml\n" in output
    run("profile", "set", "user", "timing", "slow")
    assert "machine" not in run("profile", "show", "user")[0]


def test_a_persons_own_values_are_changed_like_a_profile(home):
    assert run("profile", "set", "user", "filter", "strong")[1] == 0
    assert run("profile", "set", "user", "feedback.sound", "tones")[1] == 0
    assert run("profile", "set", "user", "feedback.volume.press", "10")[1] == 0
    text = (home / "user.yaml").read_text(encoding="utf-8")
    assert "filter: strong\n" in text
    assert "feedback: {sound: tones, volume: {press: 10}}" in text
    assert run("profile", "set", "user", "filter", "mad")[1] == 6
    assert run("profile", "check", "user")[1] == 0
    assert json.loads(run("profile", "show", "user", "--json")[0])["user"]["filter"] == "strong"
    assert run("profile", "undo", "user")[1] == 0
    assert "press" not in (home / "user.yaml").read_text(encoding="utf-8")
    assert run("profile", "new", "user")[1] == 6
    assert "feedback.volume" in " ".join(complete("profile", "set", "user", "feed"))


def test_a_persons_own_values_by_questions(home):
    # timing slow; turned by 12.5 degrees; by 999, which does not fit; sound tones; done; save
    answers = [1, 3, 5, 12.5, 5, 999, 8, 2, 9, 1]
    output, code = run("profile", "edit", "user", answers=answers)
    assert code == 0, output
    assert "That does not fit" in output
    text = (home / "user.yaml").read_text(encoding="utf-8")
    assert "timing: slow\n" in text
    assert "rotate_deg: 12.5\n" in text
    assert "feedback: {sound: tones}" in text
    assert "Nothing has changed" in run("profile", "edit", "user", answers=[9])[0]


@pytest.mark.parametrize(
    "change",
    [
        ("profile", "new", "mine"),
        ("profile", "set", "push-only", "layers.move.push.curve.expo", "0.6"),
        ("profile", "bind", "racing", "zoom", "button b"),
    ],
)
def test_a_saved_profile_that_will_not_play_is_not_promised(home, change):
    output, code = run(*change)
    assert code == 0
    assert "applies from the next start" not in output
    assert f"To play it: neurotouch profile use {change[2]}" in output


def test_a_saved_profile_that_the_favourite_extends_applies_from_the_next_start(home):
    run("profile", "new", "base")
    path = home / "profiles" / "mine.yaml"
    path.write_text("version: 1\nname: mine\nextends: [base]\n")
    used, code = run("profile", "use", "mine")
    assert code == 0, used
    output, _ = run("profile", "bind", "base", "zoom", "button b")
    assert "it applies from the next start" in output


def test_a_right_profile_without_a_description_is_not_called_wrong(home):
    run("profile", "new", "mine", "--template", "racing")
    path = home / "profiles" / "mine.yaml"
    lines = path.read_text().splitlines()
    path.write_text("\n".join(x for x in lines if not x.startswith("description:")))
    (home / "profiles" / "bad.yaml").write_text("version: 1\nname: bad\n")
    output, _ = run("profile", "list", "--plain")
    assert "mine, yours: no description\n" in output
    assert "FAILED bad, yours: it has errors, see: neurotouch profile check bad\n" in output


def test_a_file_with_a_wrong_name_is_told_and_the_fix_works_as_typed(home):
    (home / "profiles").mkdir(parents=True)
    wrong = home / "profiles" / "Uebung X.yaml"
    wrong.write_text((find_shipped_folder() / "racing.yaml").read_text())
    for command in ("list", "check"):
        output, code = run("profile", command)
        assert code == 0
        assert f"WARNING '{wrong}' is not used, because of its name.\n" in output
    fix = output.partition("Fix: ")[2].splitlines()[0]
    subprocess.run(["sh", "-euc", fix], check=True)
    output, code = run("profile", "check", "uebung-x")
    assert code == 0
    assert "the file's own name counts, so this profile is called 'uebung-x'" in output
    assert run("profile", "use", "uebung-x")[1] == 0


def test_a_copy_of_the_name_of_its_original_says_that_it_takes_its_place():
    output, _ = run("profile", "new", "default")
    assert "It begins as your own" not in output
    said = output.partition("From now on 'default' means yours everywhere, and no longer ")[2]
    assert str(find_shipped_folder() / "default.yaml") in said
    fix = said.partition("Back to that one: ")[2].splitlines()[0]
    assert run(*fix.split()[1:])[1] == 0
    run("profile", "new", "base")
    assert (
        "It begins as your own 'base' is now."
        in run(*("profile", "new", "mine", "--template", "base"))[0]
    )


def test_a_file_of_own_values_is_no_wrong_profile(home, tmp_path):
    run("profile", "set", "user", "filter", "strong")
    file = tmp_path / "me too.yaml"
    file.write_text((home / "user.yaml").read_text())
    assert run("profile", "check", file) == (f"OK {file}: no faults\n", 0)
    output, code = run("profile", "import", file)
    assert code == 6
    assert output == (
        f"'{file}' has a person's own values, and is no profile.\n"
        f"Import them: neurotouch profile import --user '{file}'"
    )


def test_a_copy_that_does_something_else_is_not_described_as_the_original_unsaid():
    run("profile", "new", "mine", "--template", "racing")
    note = "It is still described as the original. Say what it does now: "
    output, _ = run("profile", "bind", "mine", "pinch", "button b")
    assert f'{note}neurotouch profile set mine description "My words"\n' in output
    assert run("profile", "set", "mine", "description", "My words")[1] == 0
    assert note not in run("profile", "bind", "mine", "pinch", "button x")[0]


def test_what_cannot_be_written_says_what_is_needed(home):
    home.write_text("no folder")
    output, code = run("profile", "new", "mine")
    assert code == 6
    assert f"See what each part of its path is: namei -l {home}" in output


def test_a_version_with_errors_is_put_back_with_a_warning(home):
    run("profile", "set", "user", "filter", "strong")
    path = home / "user.yaml"
    right = path.read_text()
    history = home / ".history" / "user"
    history.mkdir(parents=True, exist_ok=True)
    (history / "000009-2026-01-01_00-00-00.yaml").write_text(right.replace("strong", "stronk"))
    output, code = run("profile", "undo", "user")
    assert code == 0
    assert "WARNING" in output
    assert "It has errors, so it cannot be played." in output
    fix = "neurotouch profile check user"
    assert fix in output
    assert "stronk" in run(*fix.split()[1:])[0]


def test_the_end_of_the_input_is_told_and_is_no_interrupt():
    run("profile", "new", "mine")
    command = [sys.executable, "-m", "neurotouch_hid", "profile", "edit", "mine"]
    done = subprocess.run(command, input="12\n", capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "\nError: The input has ended, so no more questions can be answered.\n" in done.stderr
