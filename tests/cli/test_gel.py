"""``neurotouch gel``: as a person and as a script type it."""

import json
import os
import pty
import select
import subprocess
import sys
from itertools import pairwise

import pytest
from click.testing import CliRunner

from neurotouch_hid.cli.main import cli
from neurotouch_hid.driver.gel_file import choose_gel, find_gel_folder
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.geometry import PAPER_GEL

ANSWERS = ("--camera", "webcam", "--hand", "large", "--way", "evening")


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(*words):
    result = CliRunner().invoke(cli, ["gel", *map(str, words)])
    error = result.exception
    if isinstance(error, NeuroTouchError):
        return f"{error.message}\n{error.hint}", error.exit_code
    if error is not None and not isinstance(error, SystemExit):
        raise error
    return result.output, result.exit_code


def test_from_the_questions_to_the_folder_without_a_terminal(home):
    output, code = run("new", *ANSWERS)
    assert code == 0
    path = find_gel_folder() / "gel.yaml"
    assert str(path) in output
    assert choose_gel(str(path)).gel.n_markers == 177
    output, code = run("show", "--svg", "gel.svg")
    assert code == 0
    assert "86 mm" in output
    assert (home / "gel.svg").read_text().startswith("<svg")
    output, code = run("make", "out")
    assert code == 0
    assert "Nobody has built this yet" in output
    assert (home / "out/stencil.pdf").exists()
    assert (home / "out/gel.yaml").read_bytes() == path.read_bytes()
    first = {each.name: each.read_bytes() for each in (home / "out").iterdir()}
    output, code = run("make", "out")
    assert code == 1
    assert "--force" in output
    assert run("make", "out", "--force")[1] == 0
    assert {each.name: each.read_bytes() for each in (home / "out").iterdir()} == first
    (home / "out/pegs.stl").write_text("of an older plan")
    output, _ = run("make", "out", "--force")
    assert "not of this plan: pegs.stl." in output


def test_a_file_that_is_there_stays(home):
    (home / "mine.yaml").write_text("mine")
    output, code = run("new", "mine.yaml", *ANSWERS)
    assert code == 6
    assert "--force" in output
    assert (home / "mine.yaml").read_text() == "mine"
    output, code = run("new", "mine.yaml", *ANSWERS, "--force", "--name", "try")
    assert code == 0
    assert choose_gel(str(home / "mine.yaml")).gel.name == "try"


@pytest.mark.parametrize("words", [(), ("config/neurotouch/mine.yaml",)])
def test_a_gel_that_cannot_be_written_is_a_fault_of_its_file(home, words):
    (home / "config").write_text("no folder")
    output, code = run("new", *words, *ANSWERS)
    assert code == 6
    assert "cannot be written: Not a directory." in output


def test_the_next_step_can_be_typed_as_it_is_written(home):
    output, code = run("new", "my own.yaml", *ANSWERS)
    assert code == 0
    assert "--gel 'my own.yaml'" in output


@pytest.mark.parametrize("name", ["12", "true", "null", "1e5", "no"])
def test_a_name_that_yaml_takes_for_something_else_stays_a_name(home, name):
    assert run("new", "a.yaml", *ANSWERS, f"--name={name}")[1] == 0
    assert choose_gel(str(home / "a.yaml")).gel.name == name


def test_the_same_figures_as_json():
    output, code = run("show", "paper", "--json")
    assert code == 0
    figures = json.loads(output)
    assert figures["dots"] == PAPER_GEL.n_markers
    assert figures["px_per_mm"] == pytest.approx(2.5, abs=0.03)
    assert 0.55 < figures["fill"] < 0.61


@pytest.mark.parametrize(
    ("height_mm", "reason"),
    [
        (15, "The dome is too steep: 15 mm high over a radius of 7.341 mm."),
        (0, "Two dots leave 0.20 mm of skin between them"),
    ],
)
def test_a_gel_that_cannot_be_made_can_be_seen_with_the_reason(home, height_mm, reason):
    layout = "layout: {kind: grid, columns: 10, rows: 8, pitch_mm: [1.2, 1.2]}\n"
    (home / "odd.yaml").write_text(f"{layout}dome_height_mm: {height_mm}\n")
    output, code = run("show", "odd.yaml", "--svg", "odd.svg")
    assert code == 0, output
    assert f"WARNING: This gel cannot be made. {reason}" in output
    assert "Fix: Set " in output
    assert (home / "odd.svg").read_text().startswith("<svg")
    assert reason in json.loads(run("show", "odd.yaml", "--json")[0])["cannot_be_made"]
    assert json.loads(run("show", "paper", "--json")[0])["cannot_be_made"] is None


def test_a_width_that_was_calculated_is_rounded(home):
    layout = "layout: {kind: grid, columns: 10, rows: 8, pitch_mm: [4, 5]}\n"
    (home / "grid.yaml").write_text(layout)
    assert "on a gel 52.21 mm wide" in run("show", "grid.yaml")[0]


@pytest.mark.parametrize(
    ("words", "code", "part"),
    [
        (("new",), 2, "--camera"),
        (("new", "a.yaml", "--camera", "own", "--hand", "small", "--way", "cast"), 2, "--width"),
        (("new", "a.yaml", *ANSWERS, "--width", "640"), 2, "--camera own"),
        *(
            (("new", "a.yaml", *ANSWERS, f"--name={name}"), 2, "cannot be used")
            for name in ("a b", "", "Ann", "-x", "a\nb", "g\udce9l")
        ),
        (("new", "none/a.yaml", *ANSWERS), 6, "'none/a.yaml' cannot be written"),
        (("show", "nothing.yaml"), 6, "nothing.yaml"),
        (("make", "out", "--gel", "nothing"), 6, "nothing"),
        (("check", "sim:nothing"), 3, "nothing"),
        (("check", "sim:rest", "--live", "--json"), 2, "--live lines for people"),
        (("check", "file:none.aedat4"), 4, "none.aedat4"),
    ],
)
def test_wrong_words_are_answered(home, words, code, part):
    output, found = run(*words)
    assert found == code, output
    assert part in output
    assert not (home / "a.yaml").exists()


def test_the_questions_are_asked_in_a_terminal(home):
    """Three questions, each answered by its number."""
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "neurotouch_hid", "gel", "new", "asked.yaml"]
    with subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs) as process:
        os.close(theirs)
        said = b""
        for answer in (b"3\n", b"1\n", b"3\n"):
            begin = len(said)
            while b"Number" not in said[begin:]:
                assert select.select([ours], [], [], 120.0)[0]
                said += os.read(ours, 4096)
            os.write(ours, answer)
        assert process.wait(120) == 0
    os.close(ours)
    gel = choose_gel(str(home / "asked.yaml")).gel
    assert gel.radius_mm == 24.0
    text = (home / "asked.yaml").read_text()
    assert "name: board" in text
    assert "way: cast" in text


def test_a_simulated_gel_is_checked():
    output, code = run("check", "sim:rest", "--json")
    score = json.loads(output)
    assert score["figures"]["source"] == "SIMULATED sim:rest"
    if score["figures"]["found"]:
        assert code == 0
        assert {each["check"] for each in score["findings"]} >= {"dots", "glare", "focus", "scale"}


def test_a_gel_that_could_not_be_made_so_is_checked(home):
    """The marker gel of docs/gel-format.md: nobody asks for room for an LED ring below it."""
    layout = "layout: {kind: grid, columns: 10, rows: 8, pitch_mm: 2.03}\n"
    (home / "mini.yaml").write_text(f"{layout}dot_mm: 0.63\ndots: dark\ndome_height_mm: 0\n")
    output, _ = run("check", "sim:rest", "--gel", "mini.yaml", "--json")
    assert json.loads(output)["findings"][0]["check"] == "gel"
    output, code = run("make", "out", "--gel", "mini.yaml")
    assert code == 1
    assert "no room for the LED ring" in output


def test_a_person_who_turns_the_lens_hears_what_changes():
    output, code = run("check", "sim:push-left", "--live")
    assert code == 0
    lines = output.splitlines()
    assert lines
    assert any("177 of 177 dots" in line for line in lines)
    assert all(a != b for a, b in pairwise(lines))
