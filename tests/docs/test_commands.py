"""Every command in the documents exists, with the options that stand there; none is carried out."""

import re
import shlex
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import click
import pytest
from click.testing import CliRunner
from markdown_it import MarkdownIt

from neurotouch_hid.cli.main import cli
from neurotouch_hid.source import FORMS
from neurotouch_hid.source.simulator import scene_names
from tests.docs.prose import ROOT, pages

_STOP = {"...", "…", "|", "||", "&&", ";", ">", ">>", "2>", "&"}
"""What ends a command in a line of code."""
_CALL = re.compile(r"^\s*(?:\$ |sudo |eval \"\$\(|\S*/bin/)*(neurotouch [a-z-].*)$")


def commands_of(text: str) -> Iterator[tuple[int, str]]:
    """Each call of ``neurotouch`` in a block of code or in a line, with its line from 1."""
    for token in MarkdownIt("commonmark").enable("table").parse(text):
        at = token.map[0] + 1 if token.map else 0
        if token.type in ("fence", "code_block") and not token.info.startswith("{"):
            for i, line in enumerate(token.content.replace("\\\n", " ").splitlines()):
                if found := _CALL.match(line):
                    yield at + i, found[1].split(')"')[0].strip()
        for child in token.children or ():
            if child.type == "code_inline" and (found := _CALL.match(child.content)):
                yield at, found[1]


def words_of(call: str) -> list[str]:
    words = []
    for word in shlex.split(call, comments=True)[1:]:
        if word in _STOP:
            break
        words.append(word)
    return words


def check(call: str) -> None:
    """Walks down the groups as click does, and has the last command parse its words.

    Raises:
        click.UsageError: there is no such command or option, or a value cannot be.
    """
    words = words_of(call)
    context = click.Context(cli, info_name="neurotouch")
    command: click.Command = cli
    while isinstance(command, click.Group):
        if not words or words[0].startswith("-"):
            break
        found = command.get_command(context, words[0])
        if found is None:
            raise click.UsageError(f"no such command: {words[0]}")
        context = click.Context(found, info_name=words.pop(0), parent=context)
        command = found
    # The parser alone: it asks for nothing and calls nothing.
    _, rest, _ = command.make_parser(context).parse_args(args=list(words))
    if rest and not isinstance(command, click.Group):
        raise click.UsageError(f"too many words: {rest}")
    for parameter in command.params:
        _check_value(parameter, words, context)


def _check_value(parameter: click.Parameter, words: list[str], context: click.Context) -> None:
    """A choice that is spelled out must be one of its words."""
    if isinstance(parameter, click.Option) and isinstance(parameter.type, click.Choice):
        for option, value in pairwise(words):
            if option in parameter.opts and not value.isupper():
                parameter.type.convert(value, parameter, context)


def found_in(page: Path) -> list[str]:
    return [f"{page.relative_to(ROOT)}:{at}: {call}" for at, call in commands_of(page.read_text())]


ALL = [call for page in pages() for call in found_in(page)]


@pytest.mark.parametrize("place", ALL)
def test_command_in_documents_exists(place: str):
    check(place.split(": ", 1)[1])


@pytest.mark.parametrize(
    "call",
    [
        "neurotouch rnu",
        "neurotouch run --sorce sim:tour",
        "neurotouch run --device toaster",
        "neurotouch profile look mine",
        "neurotouch pause now",
    ],
)
def test_wrong_command_is_found(call: str):
    with pytest.raises(click.UsageError):
        check(call)


def test_commands_are_found_in_text():
    text = "a `neurotouch run` b\n\n    sudo neurotouch setup   # why\n\n"
    text += "```\nneurotouch a \\\n --b\n```\n"
    found = [words_of(call) for _, call in commands_of(text)]
    assert found == [["run"], ["setup"], ["a", "--b"]]


def test_every_kind_of_source_is_on_the_page_of_commands():
    page = (ROOT / "docs" / "commands.md").read_text()
    assert [form for form in [*FORMS, "KIND:REST"] if f"| `{form}` |" not in page] == []


def test_every_scene_is_on_the_page_of_commands():
    page = (ROOT / "docs" / "commands.md").read_text()
    assert [name for name in scene_names() if f"`{name}`" not in page] == []


@pytest.mark.parametrize("name", ["access.md", "play.md", "profiles.md", "troubleshooting.md"])
def test_a_page_can_be_typed_from_top_to_bottom(name, tmp_path, monkeypatch):
    """Each command about profiles works after those above it, with ``y`` for every question."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))  # where no driver is
    calls = [call for _, call in commands_of((ROOT / "docs" / name).read_text())]
    if not any(call.startswith("neurotouch profile new mine") for call in calls):
        calls.insert(0, "neurotouch profile new mine --template default")
    calls = [call for call in calls if call.startswith("neurotouch profile ")]
    failed = []
    for call in calls:
        words = words_of(call)
        if words[1] == "edit" or (len(words) == 2 and words[1] not in ("list", "check")):
            continue  # it asks in a loop; only the command is named
        done = CliRunner().invoke(cli, words, input="y\n" * 5)
        if done.exit_code not in (0, 1) or (done.exception and done.exit_code == 1):
            failed.append((call, done.output, done.exception))
    assert failed == []
