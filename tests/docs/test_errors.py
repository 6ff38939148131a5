"""Errors have one form: sentences that begin with a capital and end with a full stop."""

import ast
import re

import pytest

from neurotouch_hid import errors
from tests.docs.prose import ROOT

NAMES = {name for name in dir(errors) if name.endswith("Error")} | {"WrongUsage"}
COMMAND = re.compile(
    r"(?:: |^.*\()(?:neurotouch|sudo|systemctl|apt|pip|chmod|head|ip|modprobe|kill|umask|davis:"
    r"|file:|push|add|run|\{\}|--port)[^.]*"
    r"|.*(?:NAME|/\*)\.aedat4$|.*\./devtools$|.*> \{\}\)$"
)
"""What ends with a command, which has no full stop so that it can be copied."""


def write(node):
    """Returns a text as it stands in the code, each value as ``{}``; None if it is computed."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.JoinedStr):
        return "".join(v.value if isinstance(v, ast.Constant) else "{}" for v in node.values)
    return None


def gather():
    for folder in ("neurotouch_hid", "devtools"):
        for file in sorted((ROOT / folder).rglob("*.py")):
            for node in ast.walk(ast.parse(file.read_text())):
                if not isinstance(node, ast.Call) or not node.args:
                    continue
                name = getattr(node.func, "id", getattr(node.func, "attr", ""))
                if name in NAMES and (message := write(node.args[0])) is not None:
                    hints = [write(word.value) for word in node.keywords if word.arg == "hint"]
                    place = f"{file.relative_to(ROOT)}:{node.lineno}"
                    yield pytest.param(message, (hints or [None])[0], id=place)


@pytest.mark.parametrize(("message", "hint"), list(gather()))
def test_error_is_a_sentence_and_its_fix_another(message, hint):
    # Only a place in a file comes first, as compilers write it: play.rig.yaml:3:1: ...
    assert re.match(r"[A-Z'\"]|\{\}:|\{\}$|\{\}\n|\{\} cannot be called", message), message
    assert message.endswith((".", "{}")), message
    assert not message.endswith(".."), message
    if hint is not None:
        assert re.match(r"[A-Z'\"{]", hint), hint
        assert hint.endswith((".", "?", "{}")) or COMMAND.search(hint), hint
