"""The real package, installed in a copy of this Debian: everything that is written, typed.

A person without any right types every command of the documents and of every ``--help``, in a
terminal of 80 x 24; then what the answers name as a fix. ``make try-package`` builds the package
and runs this.
"""

import json
import os
import re
import shlex
import subprocess
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

from neurotouch_hid.cli.main import cli
from tests.docs.prose import pages
from tests.docs.test_commands import commands_of, words_of

HERE = Path(__file__).parent / "installed"
DEB = os.environ.get("NEUROTOUCH_DEB", "")
LIMIT_S = 1500

REFUSES = {
    "neurotouch doctor": "finds that this machine has no camera",
    "neurotouch run --device hid": "needs a camera",
}
"""Fixes that may end with a code of their own, and why; all others must work."""

NEEDS_MORE = ("mean_push",)
"""Of calls that need the example of a package of one's own, which its own tests install."""

ENDS = (0, 130, -2)
"""Exit codes after Ctrl-C; the last one where it comes after all is done."""

PAINTS = re.compile(r"neurotouch (demo|run|monitor|record|calibrate|doctor)\b")
"""What draws, colours or counts on a terminal, and must not with NT_ACCESSIBLE."""

pytestmark = pytest.mark.skipif(not DEB, reason="needs the package: make try-package")


def list_help_calls(command: click.Command, path: str = "neurotouch") -> Iterator[str]:
    """Each example at the end of a command's help."""
    for line in (command.epilog or "").splitlines():
        if found := re.match(r" *(neurotouch .*?)(?:\s{2,}.*)?$", line):
            yield found[1]
    if isinstance(command, click.Group):
        context = click.Context(command)
        for name in command.list_commands(context):
            inner = command.get_command(context, name)
            if inner is not None:
                yield from list_help_calls(inner, f"{path} {name}")


def list_calls() -> list[str]:
    """Each call once, without what follows a pipe; without those that have a gap to fill."""
    documented = [call for page in pages() for _, call in commands_of(page.read_text())]
    found = {}
    for call in [*documented, *list_help_calls(cli)]:
        words = words_of(call)
        has_gap = re.search(r"\b[A-Z_]{3,}\b|\.\.\.", call)
        if not has_gap and not is_mere_name(words) and not set(words) & set(NEEDS_MORE):
            found[shlex.join(["neurotouch", *words])] = None
    return list(found)


def is_mere_name(words: list[str]) -> bool:
    """Tells whether a text names a command that cannot be typed without more words."""
    command: click.Command | None = cli
    for word in words:
        if not isinstance(command, click.Group):
            return False
        command = command.get_command(click.Context(command), word)
    needs = command is not None and any(each.required for each in command.params)
    return needs or (isinstance(command, click.Group) and command is not cli)


def walk(calls: list[dict]) -> list[dict]:
    done = subprocess.run(
        ["unshare", "--mount", "sh", str(HERE / "enter.sh"), DEB],
        input=json.dumps(calls),
        capture_output=True,
        text=True,
        check=False,
        timeout=LIMIT_S,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return json.loads(done.stdout[done.stdout.index("[") :])


@pytest.fixture(scope="module")
def results() -> list[dict]:
    calls = list_calls()
    wanted = [{"call": call, "accessible": False} for call in calls]
    wanted += [{"call": call, "accessible": True} for call in calls if PAINTS.match(call)]
    return walk(wanted)


def name(result: dict) -> str:
    return f"{result['call']} -> {result['code']}\n{result['output'][-600:]}"


def test_there_are_many(results):
    assert len(results) > 100


def test_no_documented_command_is_wrong_usage_or_falls_over(results):
    bad = [
        name(each)
        for each in results
        if each["code"] == 2
        or each["code"] < -2
        or re.search(r"Traceback|No module named|asyncio", each["output"])
    ]
    assert not bad, "\n\n".join(bad)


def test_what_does_not_work_here_says_why(results):
    bad = [
        name(each)
        for each in results
        if each["code"] not in ENDS and not re.search(r"Error: |Fix: |FAILED", each["output"])
    ]
    assert not bad, "\n\n".join(bad)


def test_every_command_ends_by_itself_or_at_ctrl_c(results):
    bad = [name(each) for each in results if each["interrupted"] and each["code"] not in ENDS]
    assert not bad, "\n\n".join(bad)


def test_a_picture_that_is_drawn_over_fits_the_terminal(results):
    """A line that is wider wraps, and the picture scrolls away."""
    painted = [each for each in results if re.search(r"\x1b\[\d+A\r", each["output"])]
    assert painted
    bad = [
        f"{each['call']}: {line}"
        for each in painted
        for line in re.split(r"[\r\n]+", re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", each["output"]))
        if len(line) > 80 and "http://" not in line
    ]
    assert not bad, "\n".join(bad)


def test_accessible_output_draws_nothing_over(results):
    bad = [name(each) for each in results if each["accessible"] and "\x1b[" in each["output"]]
    assert not bad, "\n\n".join(bad)


def test_the_fixes_that_are_named_work(results):
    fixes = {}
    for each in results:
        for line in each["output"].splitlines():
            if "Fix: " in line or "Next: " in line or "Start it: " in line:
                for call in re.findall(r"(?:: |or |demo: ?)(neurotouch [a-z][^.,;()'\"]*)", line):
                    fixes[call.strip()] = each["call"]
    fixes = {call: of for call, of in fixes.items() if not re.search(r"\b[A-Z_]{3,}\b", call)}
    assert fixes
    bad = [
        f"{name(each)}\n(named by {fixes[each['call']]})"
        for each in walk([{"call": call, "accessible": False} for call in fixes])
        if each["code"] not in ENDS and each["call"] not in REFUSES
    ]
    assert not bad, "\n\n".join(bad)
