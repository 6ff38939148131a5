"""Sends the guest to sleep, then resets the camera's port, while a gesture is played into the pad.

Deeper sleep is not possible here. The guest's root is a 9p file system over virtio, whose driver
cannot be suspended: with ``pm_test`` at ``devices``, as in a real sleep, the guest never wakes up.
USB/IP's host controller also refuses to sleep while a camera is plugged in (vhci_hcd_suspend).
"""

import fcntl
import multiprocessing
import os
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from evdev.ecodes import ABS_X, EV_ABS

from tests.kernel.guest import uvc
from tests.kernel.guest.driver import started
from tests.kernel.guest.reader import Reader

POWER = Path("/sys/power")
RESET = 0x5514
"""USBDEVFS_RESET, of <linux/usbdevice_fs.h>: what Linux does to a port that lost its power."""

STICK_BACK = (EV_ABS, ABS_X, 0)
FELT = 1_000
"""Of 32767: a busy guest sees few pictures of a push, and seldom its end."""

START_S = 300.0
PATIENCE_S = 100.0
"""For a gesture; the film has two in 13 s."""


def try_both(results: Path) -> dict[str, Any]:
    """What the pad does when all programs stand still for 5 s, and when the port is reset."""
    ours, theirs = multiprocessing.Pipe()
    cameras = multiprocessing.get_context("fork").Process(target=uvc.serve, args=(theirs, results))
    cameras.start()
    try:
        uvc.tell(ours, "plug")
        uvc.wait_for(uvc.list_nodes)
        with started("spacecraft", "video:", "--rate", "25") as (process, reader):
            uvc.wait_for(lambda: uvc.count_markers() > uvc.MOST_MARKERS, START_S)
            seen = {
                "sleep": disturb(reader, sleep),
                "reset": disturb(reader, reset),
            }
            process.terminate()
        return {**reader.report(), "exit_code": process.exitcode, **seen}
    finally:
        cameras.kill()


def disturb(reader: Reader, act: Callable[[], None]) -> dict[str, Any]:
    """Does something in a gesture, then waits until the pad is neutral and pressed again."""
    n_before = len(reader.events)
    reader.wait_for(lambda events: is_felt(events[n_before:]), PATIENCE_S)
    begun_s, n_begun = time.time(), len(reader.events)
    act()
    over_s = time.time()
    n_neutral = n_begun
    with suppress(TimeoutError):  # the tests say what is wrong
        reader.wait_for(lambda events: STICK_BACK in events[n_begun:], PATIENCE_S)
        n_neutral = n_begun + reader.events[n_begun:].index(STICK_BACK) + 1
        reader.wait_for(lambda events: is_felt(events[n_neutral:]), PATIENCE_S)
    return {
        "seconds": over_s - begun_s,
        "n_begun": n_begun,
        "n_after": len(reader.events),
        "neutral_s": reader.times[n_neutral - 1] - begun_s,
    }


def is_felt(events: list[tuple[int, int, int]]) -> bool:
    """Whether the stick is off its middle."""
    moves = [value for kind, code, value in list(events) if (kind, code) == (EV_ABS, ABS_X)]
    return bool(moves) and abs(moves[-1]) > FELT


def sleep() -> None:
    """Freezes all programs for 5 s, by the kernel's own test of suspending."""
    (POWER / "pm_test").write_text("freezer")
    (POWER / "state").write_text("mem")
    (POWER / "pm_test").write_text("none")


def reset() -> None:
    """Resets the camera's port, in the middle of its stream."""
    (name,) = uvc.list_nodes()
    interface = (uvc.NODES / name / "device").resolve()
    bus, device = (int((interface.parent / each).read_text()) for each in ("busnum", "devnum"))
    port = os.open(f"/dev/bus/usb/{bus:03}/{device:03}", os.O_WRONLY)
    fcntl.ioctl(port, RESET)
    os.close(port)
