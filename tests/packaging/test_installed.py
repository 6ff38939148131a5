"""The real package, installed in a copy of this Debian: everything that is written, typed.

A person without any right types every command of the documents and of every ``--help``, in a
terminal of 80 x 24, and one call of each command with NT_ACCESSIBLE; then some eighty mistakes;
then what the answers name as a fix, and the fixes of those. ``make try-package`` runs this.
"""

import json
import os
import re
import subprocess
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path

import click
import dv_processing as dv
import pytest

from neurotouch_hid.cli.main import cli
from tests.docs.prose import pages
from tests.docs.test_commands import commands_of, words_of
from tests.packaging.named_fixes import fill, join, read_fixes

HERE = Path(__file__).parent / "installed"
DEB = os.environ.get("NEUROTOUCH_DEB", "")
TABLE = tomllib.loads((HERE / "calls.toml").read_text())

LACKS = re.compile(
    r"No DAVIS camera is plugged in|There is no /dev/u\w+ here|No driver is running"
    r"|The token in \S+ cannot be read|no camera|No udev runs here"
    r"|There is no file '\S+\.labels\.csv'|'camera\.hello\.zip' exists already"
)
"""What a copy of a system has not, or a home already has. A fix that ends so has said so, and its
own fix is typed next."""

LEVELS = 3
"""Fixes of fixes of fixes."""

NEEDS_MORE = ("mean_push",)
"""Of calls that need the example of a package of one's own, which its own tests install."""

ENDS = (0, 130, -2)
"""Exit codes after Ctrl-C; the last one where it comes after all is done."""

EXPLAINED = re.compile(r"Error: |Fix: |FAILED")

Walk = Callable[[list[dict]], list[dict]]

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
    """Each call once, as a person types it, without what follows a pipe."""
    documented = [call for page in pages() for _, call in commands_of(page.read_text())]
    found = {}
    for call in [*documented, *list_help_calls(cli)]:
        words = words_of(call)
        if "..." not in call and not is_mere_name(words) and not set(words) & set(NEEDS_MORE):
            found[make_small(fill(join(["neurotouch", *words]), TABLE["gaps"]))] = None
    return list(found)


def make_small(call: str) -> str:
    for pattern, amount in TABLE["smaller"].items():
        call = re.sub(pattern, amount, call)
    return call


def find_command(words: list[str]) -> tuple[tuple[str, ...], click.Command]:
    """The command that a call begins with, after its names and those of its groups."""
    command: click.Command = cli
    for n, word in enumerate(words):
        if not isinstance(command, click.Group):
            return tuple(words[:n]), command
        inner = command.get_command(click.Context(command), word)
        if inner is None:
            return tuple(words[:n]), command
        command = inner
    return tuple(words), command


def is_mere_name(words: list[str]) -> bool:
    """Tells whether a text names a command that cannot be typed without more words."""
    names, command = find_command(words)
    if len(names) < len(words):
        return False
    needs = any(each.required for each in command.params)
    return needs or (isinstance(command, click.Group) and command is not cli)


@pytest.fixture(scope="module")
def walk(tmp_path_factory) -> Iterator[Walk]:
    """Types calls in the system with the package, which lasts as long as these tests."""
    things = tmp_path_factory.mktemp("things")
    write_zstandard(things / "zstandard.aedat4")
    log = tmp_path_factory.mktemp("log") / "installation"
    with (
        log.open("w") as said,
        subprocess.Popen(
            ["unshare", "--mount", "sh", str(HERE / "enter.sh"), DEB, str(things)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=said,
            text=True,
        ) as process,
    ):

        def type_all(calls: list[dict]) -> list[dict]:
            for each in calls:
                each["endless"] = is_endless(each["call"])
            process.stdin.write(f"{json.dumps(calls)}\n")
            process.stdin.flush()
            answer = process.stdout.readline()
            assert answer, log.read_text()[-3000:]
            return json.loads(answer)

        yield type_all
        process.stdin.close()
    assert process.returncode == 0


def is_endless(call: str) -> bool:
    return any(re.match(pattern, call) for pattern in TABLE["endless"])


def write_zstandard(path: Path) -> None:
    """A recording as the maker's software packs it."""
    config = dv.io.MonoCameraWriter.Config("camera", dv.CompressionType.ZSTD)
    config.addEventStream((346, 260))
    writer = dv.io.MonoCameraWriter(str(path), config)
    store = dv.EventStore()
    for k in range(20_000):
        store.push_back(20 * k, k % 346, k % 260, bool(k % 3))
    writer.writeEvents(store)
    del writer


@pytest.fixture(scope="module")
def results(walk) -> list[dict]:
    calls = list_calls()
    commands: dict[tuple[str, ...], str] = {}
    for call in calls:
        commands.setdefault(find_command(words_of(call))[0], call)
    ways = [(False, each) for each in calls] + [(True, each) for each in commands.values()]
    return walk([{"call": call, "accessible": way} for way, call in ways])


@pytest.fixture(scope="module")
def mistakes(walk) -> list[dict]:
    return walk([{"call": call} for call in TABLE["mistakes"]["calls"]])


@pytest.fixture(scope="module")
def fixes(walk, results, mistakes) -> list[dict]:
    return carry_out(walk, results + mistakes)


def carry_out(walk: Walk, results: list[dict]) -> list[dict]:
    """Types each fix that the answers name, after the call whose answer names it."""
    tried = {each["call"] for each in results if each["code"] in ENDS}
    found = {}
    for each in results:
        for fix in read_fixes(each["call"], each["output"], TABLE["gaps"]):
            if fix not in found and fix not in tried and not is_mere_name(words_of(fix)):
                found[fix] = {"call": make_small(fix), "of": each["call"]}
                if not each["endless"]:
                    found[fix]["before"] = each["call"]
    return walk(list(found.values()))


def name(result: dict) -> str:
    of = f"  (named by: {result['of']})" if "of" in result else ""
    return f"{result['call']} -> {result['code']}{of}\n{result['output'][-600:]}"


def list_failed(fixes: list[dict]) -> list[str]:
    return [
        name(each)
        for each in fixes
        if each["code"] not in ENDS and not LACKS.search(each["output"])
    ]


@pytest.mark.parametrize(
    "call",
    [
        "run --source sim:press --device memory --seconds 1",
        "run --source sim:press,uvc=60 --device memory --seconds 1",
        "evaluate play/*push.aedat4",
        "evaluate clips/*.mkv",
        "service --compile",
        "service --source video: --compile",
    ],
)
def test_a_person_who_starts_it_for_the_first_time_compiles_nothing(walk, call):
    first = f"XDG_CACHE_HOME=$PWD/fresh neurotouch {call} && test ! -e fresh"
    (done,) = walk([{"call": f"sh -c '{first}'"}])
    assert done["code"] == 0, name(done)


def test_there_are_many(results, mistakes):
    assert len(results) > 250
    assert len(mistakes) > 60


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
        if each["code"] not in ENDS and not EXPLAINED.search(each["output"])
    ]
    assert not bad, "\n\n".join(bad)


def test_every_command_ends_by_itself_or_at_ctrl_c(results):
    bad = [
        name(each)
        for each in results
        if each["interrupted"]
        and not (each["endless"] and (each["code"] in ENDS or EXPLAINED.search(each["output"])))
    ]
    assert not bad, "\n\n".join(bad)


def test_a_command_without_an_end_says_what_it_does(results):
    endless = [each for each in results if each["endless"]]
    bad = [name(each) for each in endless if not each["output"].strip(" ^C\r\n")]
    assert not bad, "\n\n".join(bad)


def test_a_picture_that_is_drawn_over_fits_the_terminal(results):
    """A line that is wider wraps, and the picture scrolls away."""
    painted = [each for each in results if re.search(r"\x1b\[\d+A\r", each["output"])]
    assert painted
    bad = [
        f"{each['call']}: {line}"
        for each in painted
        for line in re.split(r"[\r\n]+", re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", drawn(each)))
        if len(line) > 80 and "http://" not in line
    ]
    assert not bad, "\n".join(bad)


def drawn(result: dict) -> str:
    """The output from the first picture on; what is said before does not move."""
    return result["output"][re.search(r"\x1b\[\d+A\r", result["output"]).end() :]


def test_accessible_output_draws_nothing_over(results):
    bad = [name(each) for each in results if each["accessible"] and "\x1b[" in each["output"]]
    assert not bad, "\n\n".join(bad)


def test_a_mistake_is_explained_and_its_fix_is_named(mistakes):
    works = ("neurotouch status", "neurotouch resume")
    bad = [
        name(each)
        for each in mistakes
        if re.search(r"Traceback|No module named", each["output"])
        or (each["code"] not in ENDS and "Fix: " not in each["output"])
        or (each["code"] == 0 and each["call"] not in works)
        or (each["interrupted"] and not each["endless"])
    ]
    assert not bad, "\n\n".join(bad)


def test_the_fixes_that_are_named_work(fixes):
    assert len(fixes) > 30
    bad = list_failed(fixes)
    assert not bad, "\n\n".join(bad)


def test_the_fixes_of_fixes_work(walk, fixes):
    bad = []
    for _ in range(LEVELS - 1):
        fixes = carry_out(walk, fixes)
        bad += list_failed(fixes)
    assert not bad, "\n\n".join(bad)


def test_the_script_of_the_doctor_runs_to_its_end(walk):
    """Root types it, who may do what it asks for; a system without a camera stays without one."""
    before = "neurotouch doctor --fix-script > fix.sh"
    (made,) = walk([{"call": "cat fix.sh", "before": before}])
    assert made["output"].startswith("#!/bin/sh"), name(made)
    (ran,) = walk([{"call": "sh fix.sh", "before": before, "root": True}])
    assert ran["code"] == 0, name(ran) + made["output"]


def test_a_recording_as_the_maker_packs_it_is_read(walk):
    """Whatever Debian's own Python has by the names of our libraries."""
    call = "neurotouch run --source file:zstandard.aedat4 --speed max --device memory"
    (done,) = walk([{"call": call}])
    assert "damaged" not in done["output"]
    assert done["code"] in (0, 5), name(done)  # 5: there is no gel in it
