"""Checks that a virtual gamepad works, from the kernel to the libraries of games."""

import os
import select
import shutil
import subprocess
import time
from contextlib import closing
from typing import Final

from neurotouch_hid.device import open_device
from neurotouch_hid.doctor.finding import Finding, approve, fail, skip, warn
from neurotouch_hid.doctor.inventory import Pad, find_pads
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import Button, GamepadState

_PLAYER: Final = 97
"""A player number of its own, so that no other pad is mistaken for the test pad."""

_APPEAR_S: Final = 3.0
"""udev needs some milliseconds to give the rights, more on a busy machine."""

_BACK_S: Final = 2.0
_IGNORED: Final = ("SDL_GAMECONTROLLER_IGNORE_DEVICES", "SDL_JOYSTICK_BLACKLIST_DEVICES")
_ONLY: Final = "SDL_GAMECONTROLLER_IGNORE_DEVICES_EXCEPT"
_KNOWN: Final = {("045e:028e", 0x0110), ("045e:028e", 0x0114)}
"""Identities that the mapping databases of SDL have, with these versions."""


def check_loopback() -> Finding:
    """Makes a pad, presses A and reads it back as a game would."""
    import evdev

    try:
        pad = open_device("uinput", player=_PLAYER)
    except DeviceError as error:
        return skip(f"Needs the virtual gamepad. {error.message}")
    with pad:
        made = _wait_for_pad()
        if made is None:
            return fail(
                "The kernel took the pad, but no event node appeared.",
                "Load the module evdev. In a container, pass /dev/input on.",
                "sudo modprobe evdev",
            )
        if not made.readable:
            return warn(
                f"The pad was made, but its event node {made.node} cannot be read from here.",
                "Log in at the machine itself; over ssh, join the group input and log in again.",
            )
        with closing(evdev.InputDevice(made.node)) as reader:
            begun = time.perf_counter()
            pad.write(GamepadState(0, frozenset({Button.A})))
            if not select.select([reader], [], [], _BACK_S)[0]:
                return fail(
                    f"A press of A was written, but did not come back at {made.node} within "
                    f"{_BACK_S:.0f} s.",
                    "Does another program grab game controllers? See the check 'remappers'.",
                )
            took_ms = (time.perf_counter() - begun) * 1e3
    return approve(f"A press of A came back after {took_ms:.2f} ms ({made.node}).")


def check_recognition() -> Finding:  # noqa: PLR0911
    """Checks whether udev and SDL take our pad for a game controller."""
    hidden = _find_hiding()
    if hidden:
        return warn(
            f"The variable {hidden} is set, so games may not see our pad.",
            f"Start the game without it: env -u {hidden} GAME",
        )
    if not shutil.which("udevadm"):
        return skip("udev is not installed here.")
    try:
        pad = open_device("uinput", player=_PLAYER)
    except DeviceError:
        return skip("Needs the virtual gamepad.")
    with pad:
        made = _wait_for_pad()
        if made is None:
            return skip("Needs the event node of the pad.")
        said = _ask_udev(made.node)
    if not said:
        return skip(
            "No udev runs here; games then judge the pad by its buttons, which are correct."
        )
    if said.get("ID_INPUT_JOYSTICK") != "1":
        return fail(
            "udev does not take our pad for a game controller (ID_INPUT_JOYSTICK is missing).",
            f"A rule of another program interferes. See: udevadm test {made.node}",
        )
    if (made.usb_id, made.ids[3]) not in _KNOWN:
        return warn(
            f"udev says game controller, but SDL has no mapping of its own for {made.usb_id}.",
            "Use the default identity, xbox360.",
        )
    return approve(f"udev says game controller, and SDL knows {made.usb_id} ({made.name}).")


def _find_hiding() -> str:
    """Returns the variable by which SDL ignores our usual pad, if one is set."""
    for name in _IGNORED:
        if "0x045e/0x028e" in os.environ.get(name, "").lower():
            return name
    only = os.environ.get(_ONLY, "").lower()
    return _ONLY if only and "0x045e/0x028e" not in only else ""


def _wait_for_pad() -> Pad | None:
    """Returns our pad as soon as it is readable; unreadable, or None, when time is up."""
    deadline = time.monotonic() + _APPEAR_S
    while True:
        made = next((pad for pad in find_pads() if pad.place.endswith(f"pad{_PLAYER - 1}")), None)
        if (made is not None and made.readable) or time.monotonic() > deadline:
            return made
        time.sleep(0.05)


def _ask_udev(node: str) -> dict[str, str]:
    """Returns udev's properties of a node; empty where no udev runs."""
    deadline = time.monotonic() + _APPEAR_S
    while True:
        done = subprocess.run(  # noqa: S603
            ["udevadm", "info", "--query=property", f"--name={node}"],  # noqa: S607
            capture_output=True,
            text=True,
            check=False,
            timeout=5,
        )
        said = dict(line.split("=", 1) for line in done.stdout.splitlines() if "=" in line)
        if "USEC_INITIALIZED" in said or time.monotonic() > deadline:
            return said if "USEC_INITIALIZED" in said else {}
        time.sleep(0.05)
