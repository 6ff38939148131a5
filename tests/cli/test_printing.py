"""Nothing that comes from elsewhere steers a terminal, whichever command shows it."""

import ast
import json
import os
import pty
import subprocess
import sys
from pathlib import Path

import click
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

import neurotouch_hid
from neurotouch_hid.cli.ui.output import echo, print_json, say, show_changes
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.printable import make_lines_printable, make_printable
from tests.processes import run_neurotouch

EVIL = "\x1b]0;owned\a\x1b[8m\u202e\x9b2K\x7f\udc80"
CLI = Path(neurotouch_hid.__file__).with_name("cli")
RAW = {
    "ui/output.py": 6,  # the one place
    "main.py": 1,  # before any command is imported
    "monitor.py": 1,  # these three draw over their own last lines
    "record_progress.py": 3,
    "doctor.py": 1,  # a script
    "schema.py": 1,  # files of the program
    "completion.py": 1,
}
"""The calls that print as it is, and why."""


def test_commands_print_in_one_place():
    found = {}
    for path in CLI.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and ast.unparse(node.func) in ("click.echo", "print"):
                name = str(path.relative_to(CLI))
                found[name] = found.get(name, 0) + 1
    assert found == RAW


def show(function, *arguments, **more) -> str:
    command = click.Command("x", callback=lambda: function(*arguments, **more))
    return CliRunner().invoke(command).output


@pytest.mark.parametrize(
    "said",
    [
        show(echo, EVIL),
        show(say, "OK", EVIL, EVIL),
        show(show_changes, [("added", 1, EVIL)], plain=True),
        str(NeuroTouchError(EVIL)),
        NeuroTouchError("x", hint=EVIL).hint,
        make_lines_printable(EVIL),
        make_printable(EVIL + "\n"),
    ],
)
def test_what_steers_a_terminal_is_taken_out(said):
    assert "owned" in said
    assert all(line.isprintable() for line in said.rstrip("\n").split("\n"))


def test_a_file_goes_byte_by_byte_into_a_pipe_and_printable_to_a_terminal(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    profile = tmp_path / "neurotouch/profiles/evil.yaml"
    profile.parent.mkdir(parents=True)
    text = (
        "version: 1\nname: evil  # owned \u202e\u2066\u061c\n"
        "bindings:\n  - {when: pinch, do: {button: a}}\n"
    )
    profile.write_text(text)
    export = [sys.executable, "-m", "neurotouch_hid", "profile", "export", "evil"]
    assert subprocess.run(export, capture_output=True, check=True).stdout.decode() == text
    terminal, inside = pty.openpty()
    subprocess.run(export, stdout=inside, check=True)
    os.close(inside)
    shown = os.read(terminal, 4096).decode()
    os.close(terminal)
    assert shown.splitlines() == make_lines_printable(text).splitlines()
    assert "owned ���" in shown


@given(st.text())
def test_lines_stay_lines_and_all_is_printable(text):
    lines = make_lines_printable(text).split("\n")
    assert len(lines) == len(text.split("\n"))
    assert all(char.isprintable() or char in "\u200c\u200d" for line in lines for char in line)


@given(st.recursive(st.text(), lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner)))
def test_json_says_the_same_in_visible_characters(value):
    said = show(print_json, value)
    assert json.loads(said) == value
    assert all(line.isprintable() for line in said.replace("\u200c", "").split("\n"))


def test_a_command_line_is_quoted_without_what_steers():
    done = run_neurotouch("profile", "show", "x\x1b[8m\u202e", code=6)
    assert done.stderr.startswith("Error: ")
    assert "\x1b" not in done.stderr
    done = run_neurotouch("x\x1b[8m", code=2)
    assert "\x1b" not in done.stderr
