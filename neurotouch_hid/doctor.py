"""Checks a machine from Python to the finished gamepad; every failure comes with its way out."""

import select
import struct
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from enum import StrEnum
from pathlib import Path

from neurotouch_hid.errors import DeviceError, NeuroTouchError


class Status(StrEnum):
    """Outcome of one check. Only FAILED makes the doctor's exit code 1."""

    OK = "OK"
    WARNING = "WARNING"
    FAILED = "FAILED"
    SKIPPED = "SKIPPED"


@dataclass(frozen=True, slots=True)
class Finding:
    """What one check found: a status, a sentence, and how to mend it."""

    check: str
    status: Status
    sentence: str
    fix: str | None = None

    def as_json(self) -> dict[str, str | None]:
        """The same for programs."""
        return asdict(self)


def examine() -> Iterator[Finding]:
    """Runs all checks, one after another; yields each finding as soon as it is known."""
    for name, check in _CHECKS.items():
        try:
            yield check(name)
        except NeuroTouchError as error:
            yield Finding(name, Status.FAILED, error.message, error.hint)


def _check_python(name: str) -> Finding:
    version = ".".join(map(str, sys.version_info[:3]))
    bits = struct.calcsize("P") * 8
    if sys.version_info < (3, 11) or bits != 64:
        return Finding(
            name,
            Status.FAILED,
            f"Python {version}, {bits} bit.",
            "Use 64-bit Python 3.11 or newer.",
        )
    return Finding(name, Status.OK, f"Python {version}, 64 bit.")


def _check_line(name: str) -> Finding:
    """Plays a simulated push through the whole line, as fast as it goes."""
    from neurotouch_hid.device import MemoryDevice
    from neurotouch_hid.gesture import GestureConfig
    from neurotouch_hid.profile import load_profile
    from neurotouch_hid.runtime import Pipeline, run_line, warm_up
    from neurotouch_hid.source import open_source

    profile = load_profile("default")
    warm_up(Pipeline.build(profile, GestureConfig()))
    device = MemoryDevice()
    with open_source("sim:push", speed="max") as source:
        packets = list(source)
    stats = run_line(packets, Pipeline.build(profile, GestureConfig()), device)
    if not any(state.axes for state in device.states):
        return Finding(
            name, Status.FAILED, "A simulated push did not move the pad.", "Report this as a bug."
        )
    speed = stats.sensor_s / stats.host_s
    sentence = f"A simulated push moves the pad; this machine is {speed:.0f} times real time."
    if speed < 2:
        return Finding(name, Status.WARNING, sentence, "Close other programs, or use a faster one.")
    return Finding(name, Status.OK, sentence)


def _check_profiles(name: str) -> Finding:
    from neurotouch_hid.profile import list_profiles, load_profile

    names = list_profiles()
    for profile in names:
        load_profile(profile)
    return Finding(name, Status.OK, f"{len(names)} profiles are in order: {', '.join(names)}.")


def _check_uinput(name: str) -> Finding:
    from neurotouch_hid.device import open_device

    open_device("uinput").close()
    return Finding(name, Status.OK, "A virtual gamepad can be made through /dev/uinput.")


def _check_loopback(name: str) -> Finding:
    """Makes the pad, presses A and reads it back as a game would."""
    import evdev

    from neurotouch_hid.device import open_device
    from neurotouch_hid.device.gamepad import PHYS
    from neurotouch_hid.messages import Button, GamepadState

    try:
        pad = open_device("uinput")
    except DeviceError:
        return Finding(name, Status.SKIPPED, "Needs the virtual gamepad.")
    with pad:
        node = _find_readable(PHYS)
        if node is None:
            return Finding(
                name,
                Status.WARNING,
                "The pad was made, but its event node cannot be read from here.",
                "Log in at the machine itself; over ssh, join the group input and log in again.",
            )
        with evdev.InputDevice(node) as reader:
            begun = time.perf_counter()
            pad.write(GamepadState(0, frozenset({Button.A})))
            if not select.select([reader], [], [], 1.0)[0]:
                return Finding(name, Status.FAILED, "A press of A did not come back within 1 s.")
            took_ms = (time.perf_counter() - begun) * 1e3
    return Finding(name, Status.OK, f"A press of A came back after {took_ms:.2f} ms ({node}).")


def _find_readable(phys: str) -> str | None:
    """The event node of our pad; udev needs some milliseconds to give the rights."""
    import evdev

    for _ in range(20):
        for node in evdev.list_devices():
            with evdev.InputDevice(node) as device:
                if device.phys == phys:
                    return str(node)
        time.sleep(0.05)
    return None


def _check_keyboard(name: str) -> Finding:
    from neurotouch_hid.device import explain_keyboards, find_keyboards

    keyboards = find_keyboards()
    sentence, fix = explain_keyboards(keyboards)
    sentence = f"{sentence[0].upper()}{sentence[1:]}."
    if not keyboards:
        return Finding(name, Status.SKIPPED, sentence)
    return Finding(name, Status.WARNING if fix else Status.OK, sentence, fix)


def _check_camera(name: str) -> Finding:
    for vendor in Path("/sys/bus/usb/devices").glob("*/idVendor"):
        ids = vendor.read_text().strip(), vendor.with_name("idProduct").read_text().strip()
        if ids == ("152a", "841a"):
            return Finding(
                name,
                Status.WARNING,
                "A DAVIS camera is plugged in, but this version cannot read it yet.",
                "Use a recording (file:NAME.aedat4) or the simulator (sim:tour).",
            )
    return Finding(name, Status.SKIPPED, "No DAVIS camera is plugged in.")


_CHECKS: dict[str, Callable[[str], Finding]] = {
    "python": _check_python,
    "profiles": _check_profiles,
    "line": _check_line,
    "uinput": _check_uinput,
    "loop-back": _check_loopback,
    "keyboard": _check_keyboard,
    "camera": _check_camera,
}
