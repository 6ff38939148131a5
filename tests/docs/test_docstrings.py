"""The first word of a docstring: a noun or a verb in the third person, never a question."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.docs.prose import ROOT

PACKAGES = ("neurotouch_hid", "devtools", "examples")
QUESTION = re.compile(
    r"(What|How|Who|Whose|When|Where|Whether|Which|Why|From|Is|Are|May|Has the|Does (?!nothing))\b"
)
COMMAND = re.compile(r"^``[^`]*``( \w+)?: ")
"""``neurotouch run``: what follows is the first word."""

FILES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_first_sentence_says_what_comes_out(path: Path):
    assert list(find_questions(path.read_text("utf-8"))) == []


@pytest.mark.parametrize(
    "text",
    [
        '"""What a check finds."""',
        '"""``neurotouch status``: what the driver does."""',
        'class A:\n    """How a pad is built."""',
        'def f():\n    """Whether it is there."""',
        '"""Does Steam run?"""',
        '"""A sentence with a mark at its end?"""',
    ],
)
def test_question_is_found(text: str):
    assert len(list(find_questions(text))) == 1


@pytest.mark.parametrize(
    "text",
    [
        '"""Checks for Steam. What it finds is a status."""',
        '"""``neurotouch status``: prints the state."""',
        'def f():\n    """Does nothing: there is nothing to close."""',
        '"""Framing of a file."""',
    ],
)
def test_statement_is_not(text: str):
    assert list(find_questions(text)) == []


def find_questions(text: str) -> Iterator[str]:
    """Yields each docstring of a module that begins with a question, with its line."""
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        docstring = ast.get_docstring(node)
        if docstring is None:
            continue
        first = re.split(r"(?<=[.?])\s", " ".join(docstring.split()))[0]
        words = COMMAND.sub("", first)
        if QUESTION.match(words[:1].upper() + words[1:]) or first.endswith("?"):
            yield f"line {node.body[0].lineno}: {first}"
