"""Tab completion as bash asks for it."""

import os
import sys

import pytest

from tests.processes import run_command, run_neurotouch

ASK = """\
source completion.sh
compopt() { :; }
COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
_neurotouch_completion neurotouch
printf '%s\\n' "${COMPREPLY[@]}"
"""


@pytest.fixture
def ask(tmp_path, monkeypatch):
    """Returns what bash offers for words as it splits them; the folder has some files."""
    for name in ("clip.mkv", "my clip.mkv", "notes.txt"):
        (tmp_path / name).touch()
    program = tmp_path / "bin" / "neurotouch"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec {sys.executable} -m neurotouch_hid "$@"\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}:{os.environ['PATH']}")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    (tmp_path / "completion.sh").write_text(run_neurotouch("completion", "bash").stdout)

    def ask_bash(*words: str) -> list[str]:
        done = run_command("bash", "-c", ASK, "bash", "neurotouch", *words, cwd=tmp_path)
        return done.stdout.splitlines()

    return ask_bash


@pytest.mark.parametrize(
    ("words", "offers"),
    [
        (("profile", "sho"), ["show"]),
        (("run", "--profile", "rac"), ["racing"]),
        (("run", "--profile", "=", "rac"), ["racing"]),
        (("run", "--source", "dri"), ["driver:"]),
        (("run", "--source", "sim", ":", "to"), ["tour"]),
        (("run", "--source", "=", "sim", ":", "to"), ["tour"]),
        (("run", "--source", "sim:to"), ["sim:tour"]),  # where a person's bash splits at no colon
        (("run", "--source", "file", ":"), ["bin/", "clip.mkv", r"my\ clip.mkv"]),
        (("run", "--source", "file", ":", r"my\ c"), [r"my\ clip.mkv"]),
        (("run", "--source", "sim", ":", "tour", "--met"), ["--method"]),
        (("demo", "--scene", "push-l"), ["push-left"]),
    ],
)
def test_bash_gets_what_it_replaces(ask, words, offers):
    assert ask(*words) == offers
