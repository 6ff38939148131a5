"""Every path that the page names is there."""

import re
import tomllib
from pathlib import Path

import pytest

from tests.docs.prose import ROOT
from tests.processes import run_command

PAGE = ROOT / "docs" / "develop" / "where.md"
ROWS = [
    line for line in PAGE.read_text(encoding="utf-8").splitlines() if "?" in line and "`" in line
]


def test_there_are_twenty_questions():
    assert len([row for row in ROWS if row.startswith("| ")]) >= 20


def test_import_rules_are_those_of_the_linter():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    _, rules = PAGE.read_text(encoding="utf-8").split("| rule | what it says |\n| --- | --- |\n")
    named = re.findall(r"^\| ([^|]+) \|", rules, re.MULTILINE)
    assert named == [contract["name"] for contract in contracts]


def test_every_room_says_why_to_go_there():
    _, table = read_develop().split("| room | what it does | go there to |\n| --- | --- | --- |\n")
    rooms = [row.strip("|").split("|") for row in table.split("\n\n")[0].splitlines()]
    assert [room for room, _, reason in rooms if not reason.strip()] == []


def read_develop() -> str:
    return (ROOT / "docs" / "develop" / "index.md").read_text(encoding="utf-8")


def test_every_top_level_module_has_a_room():
    _, table = read_develop().split("| room | what it does | go there to |\n| --- | --- | --- |\n")
    rooms = re.findall(
        r"`([^`]+)`", "\n".join(row.split("|")[1] for row in table.split("\n\n")[0].splitlines())
    )
    package = ROOT / "neurotouch_hid"
    files = {path.name for path in package.glob("*.py")} - {"__init__.py"}
    folders = {f"{path.parent.name}/" for path in package.glob("*/__init__.py")}
    assert {room for room in rooms if not room.startswith("../")} >= files | folders


def test_the_picture_of_the_layers_is_that_of_the_linter():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    (layers,) = (contract["layers"] for contract in contracts if contract["type"] == "layers")
    picture = read_develop().split("## Who may import whom\n")[1].split("\n\n")[1]
    drawn = [line.strip().split("    ")[0] for line in picture.splitlines()]
    assert drawn == layers


@pytest.mark.parametrize("row", ROWS)
def test_the_path_is_there(row):
    answer = row.split("?", 1)[1]
    for path in re.findall(r"`([^`]+)`", answer):
        assert (ROOT / "neurotouch_hid" / path).exists() or (ROOT / path).exists(), path


DEVELOP = sorted((ROOT / "docs" / "develop").rglob("*.md"))


@pytest.mark.parametrize("page", DEVELOP, ids=lambda page: page.stem)
def test_files_that_a_page_names_are_there(page: Path):
    named = re.findall(r"`((?:[\w.-]+/)*[\w-]+\.(?:py|toml))`", page.read_text(encoding="utf-8"))
    tracked = ["/" + path for path in list_files()]
    gone = [name for name in named if not any(path.endswith("/" + name) for path in tracked)]
    assert gone == []


def list_files() -> list[str]:
    """All files under version control, from the repository's root."""
    command = ["git", "ls-files"]
    done = run_command(*command, cwd=ROOT)
    return done.stdout.splitlines()
