"""Tab completion as bash asks for it."""

import os
import pty
import shutil
import subprocess
import sys
from contextlib import suppress

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
        (("hello", "--source", "d"), ["davis:"]),
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


@pytest.mark.parametrize(
    ("line", "offers"),
    [
        ("run --profile rac", ["racing"]),
        ("run --profile=rac", ["--profile=racing"]),
        ("run --source=sim:tou", ["--source=sim:tour"]),
        ("run --gel=cl", ["--gel=clip.mkv"]),
        ("hello --source dr", []),
    ],
)
@pytest.mark.skipif(shutil.which("fish") is None, reason="fish is not installed")
def test_fish_offers_what_begins_as_the_word_does(ask, tmp_path, line, offers):
    source = run_neurotouch("completion", "fish").stdout
    asked = f"{source}\ncomplete -C 'neurotouch {line}'"
    done = run_command("fish", "-c", asked, cwd=tmp_path)
    assert [each.split("\t")[0] for each in done.stdout.splitlines()] == offers


ZSHRC = """\
autoload -Uz compinit; compinit -u -D
source completion.zsh
bindkey '^I' complete-word
finish() { print -rn -- "$BUFFER" > typed; exit }; zle -N finish; bindkey '^G' finish
"""


@pytest.mark.parametrize(
    ("line", "becomes"),
    [
        ("run --profile rac", "run --profile racing "),
        ("run --profile=rac", "run --profile=racing "),
        ("run --source=sim:tou", "run --source=sim:tour "),
        ("run --gel=cl", "run --gel=clip.mkv "),
    ],
)
@pytest.mark.skipif(shutil.which("zsh") is None, reason="zsh is not installed")
def test_zsh_keeps_the_option_before_the_value(ask, tmp_path, line, becomes):
    (tmp_path / "completion.zsh").write_text(run_neurotouch("completion", "zsh").stdout)
    (tmp_path / ".zshrc").write_text(ZSHRC)
    ours, its = pty.openpty()
    environment = {**os.environ, "ZDOTDIR": str(tmp_path), "TERM": "dumb"}
    places = {"stdin": its, "stdout": its, "stderr": its, "cwd": tmp_path}
    with subprocess.Popen(["zsh", "-i"], **places, env=environment, start_new_session=True):
        os.close(its)
        os.write(ours, f"neurotouch {line}\t\a".encode())
        with suppress(OSError):  # the shell has ended
            while os.read(ours, 4096):
                pass
    os.close(ours)
    assert (tmp_path / "typed").read_text() == f"neurotouch {becomes}"


def test_the_parts_that_the_shells_need_are_in_their_scripts():
    """click's own scripts are changed, where they are as expected."""
    assert "compset -P 1 '--*='" in run_neurotouch("completion", "zsh").stdout
    fish = run_neurotouch("completion", "fish").stdout
    assert fish.count("$option") == 2
