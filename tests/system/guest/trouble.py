"""Faults around the service: the clock, the disk, the memory, and a machine that stands still."""

import json
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from tests.system.guest.desk import Desk
from tests.system.guest.observation import (
    GEAR,
    PLAYER,
    Reader,
    run,
    run_as,
    wait_for,
)

_FILL = Path("/var/fill")
_JUMPS = ("+9 hours", "-20 hours", "+11 hours")
_HOG = """\
import sys, time
open("/proc/self/oom_score_adj", "w").write("1000")
held = []
while True:
    free = next(int(line.split()[1]) for line in open("/proc/meminfo") if "MemAvailable" in line)
    if free < 60_000 and len(sys.argv) > 1:
        time.sleep(10)
        sys.exit()
    held.append(bytearray(b"x") * (8 << 20))
"""
"""Takes memory until 60 MB are left and holds it; without a word more, until it is killed."""


def jump(desk: Desk) -> dict[str, Any]:
    """The clock goes forward and back by hours, in the middle of gestures."""
    before = desk.identity()
    answers = []
    for step in _JUMPS:
        reader = desk.play_until_pushed()
        run("date", "--set", step)
        _see_gesture(reader)
        answers.append(run("neurotouch", "status", "--json"))
    return {
        "same": before == desk.identity(),
        "codes": [each["code"] for each in answers],
        "errors": [json.loads(each["out"])["errors"] for each in answers],
    }


def fill(desk: Desk) -> dict[str, Any]:
    """The disk is full while a person saves; then there is room again."""
    reader, before = desk.play_until_pushed(), desk.identity()
    free = int(run("df", "--output=avail", "--block-size=1", "/")["out"].split()[-1])
    run("fallocate", "--length", str(free), str(_FILL))
    with suppress(OSError), _FILL.open("ab", buffering=0) as file:
        while True:  # the blocks kept for root, too
            file.write(bytes(1 << 20))
    return _save_in_vain(reader, _FILL.unlink, desk, before)


def protect(desk: Desk) -> dict[str, Any]:
    """The disk is read-only, as after an error, while a person saves; then it can be written."""
    reader, before = desk.play_until_pushed(), desk.identity()
    Path("/proc/sysrq-trigger").write_text("u")
    wait_for(_is_read_only)
    return _save_in_vain(reader, _allow_writing, desk, before)


def hog(desk: Desk) -> dict[str, Any]:
    """Another program takes all memory: first nearly, then until it is killed."""
    reader, before = desk.play_until_pushed(), desk.identity()
    codes = []
    # A unit of its own: systemd stops the one of which the kernel has killed a process.
    apart = ("systemd-run", "--scope", "--quiet")
    for words in (["hold"], []):
        command = [*apart, sys.executable, "-c", _HOG, *words]
        codes.append(subprocess.run(command, check=False).returncode)
        _see_gesture(reader)
    return {"codes": codes, "same": before == desk.identity()}


def freeze(desk: Desk) -> dict[str, Any]:
    """All programs stand still for five seconds, as when a laptop sleeps, in a gesture.

    The camera's program too; the kernel's own test of suspending, without its devices, does it.
    """
    reader, before = desk.play_until_pushed(), desk.identity()
    Path("/sys/power/pm_test").write_text("freezer")
    begun_s = time.monotonic()
    Path("/sys/power/state").write_text("mem")
    awake_s = time.monotonic()
    Path("/sys/power/pm_test").write_text("none")
    _see_gesture(reader)
    return {
        "seconds": awake_s - begun_s,
        "neutral_after_s": reader.first_neutral_after(awake_s),
        "same": before == desk.identity(),
    }


def _see_gesture(reader: Reader) -> None:
    """Waits for the end of a gesture and the next one, as the pad tells them."""
    wait_for(reader.is_neutral)
    wait_for(reader.is_pushed)


def _save_in_vain(
    reader: Reader, mend: Callable[[], object], desk: Desk, before: tuple[str | None, int]
) -> dict[str, Any]:
    """A person saves a choice, which cannot be; mended, it can. Play goes on all the time."""
    values = Path(f"/home/{PLAYER}/.config/neurotouch/user.yaml")
    text = values.read_text() if values.exists() else None
    saw: dict[str, Any] = {"refused": run_as(PLAYER, "neurotouch", "profile", "use", "racing")}
    saw["kept"] = text == (values.read_text() if values.exists() else None)
    _see_gesture(reader)
    saw["left_pressed"] = GEAR in reader.pressed()
    saw["same"] = before == desk.identity()
    mend()
    saw["saved"] = run_as(PLAYER, "neurotouch", "profile", "use", "racing")
    wait_for(lambda: GEAR in reader.pressed())
    desk.forget_choice()
    return saw


def _is_read_only() -> bool:
    lines = [line.split() for line in Path("/proc/mounts").read_text().splitlines()]
    return any(at == "/" and "ro" in options.split(",") for _, at, _, options, *_ in lines)


def _allow_writing() -> None:
    run("mount", "-o", "remount,rw", "/")
