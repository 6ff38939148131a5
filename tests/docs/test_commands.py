"""Every command in the documents exists, with the options that stand there; none is carried out."""

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import click
import pytest
from markdown_it import MarkdownIt

from neurotouch_hid.cli.main import cli
from tests.docs.prose import ROOT, pages

# An ellipsis stands for the rest, a parenthesis or a second command ends it.
_STOP = re.compile(r"^(\.\.\.|…|\||\|\||&&|;|>|>>|2>|&|#.*|\)|\()$")
_PLACEHOLDER = re.compile(r"\.\.\.$|…$")


def commands_of(text: str) -> Iterator[tuple[int, str]]:
    """Each line of code, and each code in a line, that calls ``neurotouch``, with its line."""
    for token in MarkdownIt("commonmark").enable("table").parse(text):
        if token.type in ("fence", "code_block") and not token.info.startswith("{"):
            joined = token.content.replace("\\\n", "  ")
            for i, line in enumerate(joined.splitlines()):
                yield from ((token.map[0] + i + 1, one) for one in _calls(line))
        for child in token.children or ():
            if child.type == "code_inline" and re.match(r"neurotouch [a-z-]", child.content):
                yield token.map[0] + 1, child.content


def _calls(line: str) -> Iterator[str]:
    found = re.search(r"(?:^|[ /\"(])(neurotouch [a-z-].*)$", line.split("  #")[0].split(" # ")[0])
    if found and re.match(r"^\s*(\$ )?(sudo |eval \"\$\(|chrt [^n]*|\S*/bin/)*neurotouch ", line):
        yield re.split(r"\)\"| {3,}", found[1])[0]


def words_of(call: str) -> list[str]:
    words = []
    for word in shlex.split(call, comments=True)[1:]:
        if _STOP.match(word):
            break
        words.append(word)
    return words


def check(call: str) -> None:
    """Walks down the groups as click does, and has the last command parse its words.

    Raises:
        click.UsageError: there is no such command or option, or a value cannot be.
    """
    words = [word for word in words_of(call) if not _PLACEHOLDER.search(word)]
    is_whole = len(words) == len(words_of(call))
    context = click.Context(cli, info_name="neurotouch")
    command: click.Command = cli
    while isinstance(command, click.Group):
        if not words or words[0].startswith("-"):
            break
        found = command.get_command(context, words[0])
        if found is None and (is_optional(command) or not is_whole):
            break
        if found is None:
            raise click.UsageError(f"no such command: {words[0]}")
        context = click.Context(found, info_name=words.pop(0), parent=context)
        command = found
    context.resilient_parsing = True  # no defaults, no prompts, no callbacks
    parser = command.make_parser(context)
    _, rest, _ = parser.parse_args(args=list(words))
    if rest and not isinstance(command, click.Group):
        raise click.UsageError(f"too many words: {rest}")
    for parameter in command.params:
        _check_value(parameter, words, context)


def is_optional(command: click.Group) -> bool:
    return any(isinstance(parameter, click.Argument) for parameter in command.params)


def _check_value(parameter: click.Parameter, words: list[str], context: click.Context) -> None:
    """A choice that is spelled out must be one of its words."""
    if isinstance(parameter, click.Option) and isinstance(parameter.type, click.Choice):
        for option, value in zip(words, words[1:], strict=False):
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
        "neurotouch run --device memroy",
        "neurotouch profile chek mine",
        "neurotouch pause now",
    ],
)
def test_wrong_command_is_found(call: str):
    with pytest.raises(click.UsageError):
        check(call)


def test_commands_are_found_in_text():
    text = "a `neurotouch run` b\n\n    sudo neurotouch setup   # why\n\n```\nneurotouch a \\\n --b c\n```\n"
    assert [call for _, call in commands_of(text)] == [
        "neurotouch run",
        "neurotouch setup",
        "neurotouch a",
    ] or [call for _, call in commands_of(text)][2].split() == ["neurotouch", "a", "--b", "c"]
