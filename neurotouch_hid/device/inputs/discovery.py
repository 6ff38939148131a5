"""Finds the devices that can act as co-pilot, and explains why one cannot be used."""

import os
from errno import EBUSY, ENODEV
from operator import attrgetter
from pathlib import Path
from typing import Final

from evdev import ecodes

from neurotouch_hid.device.inputs.nodes import Input, find_inputs
from neurotouch_hid.errors import DeviceError

AUTO: Final = "auto"

_STEAM: Final = (0x28DE, 0x11FF)
"""Steam's own virtual pad, which repeats the others."""


def find_copilot(wanted: str) -> Input:
    """Returns the device that matches a person's words.

    Args:
        wanted: ``auto`` for the first gamepad, the path of an event node, or a part of a name.

    Raises:
        DeviceError: there is none, or more than one has this in its name.
    """
    inputs = find_inputs()
    if wanted == AUTO:
        found = [each for each in inputs if _is_pad(each)]
    elif wanted.startswith("/"):
        real = Path(os.path.realpath(wanted))
        found = [each for each in inputs if each.node == real]
    else:
        named = [each for each in inputs if wanted.casefold() in each.name.casefold()]
        exact = [each for each in named if each.name == wanted]
        # Recent pads have further nodes for motion and touch beside the one with buttons.
        found = exact or [each for each in named if each.keys]
        if len(found) > 1 and wanted != found[0].name:
            raise DeviceError(
                f"'{wanted}' could be {_list(found)}.", hint="Name it by its node, or in full."
            )
    if not found:
        others = _list([each for each in inputs if each.keys])
        raise DeviceError(
            "No gamepad is plugged in."
            if wanted == AUTO
            else f"There is no input device '{wanted}' (our own pads do not count).",
            hint=f"Use one of these: {others}."
            if others
            else "Plug it in, then list what this machine sees: neurotouch devices",
        )
    return found[0]


def _is_pad(device: Input) -> bool:
    keys, axes = device.keys, device.axes
    return bool(
        keys >> ecodes.BTN_GAMEPAD & 1
        and axes >> ecodes.ABS_X & 1
        and (device.vendor, device.product) != _STEAM
    )


def find_alike(device: Input) -> list[Input]:
    """Returns the devices of this kind.

    Of two alike the serial number decides, if they have one.
    """
    facts = attrgetter("name", "vendor", "product", "keys", "axes", "uniq")
    return [each for each in find_inputs() if facts(each) == facts(device)]


def _list(inputs: list[Input]) -> str:
    return ", ".join(f"{each.node} ({each.name})" for each in inputs)


def explain_opening(device: Input, error: OSError) -> DeviceError:
    """Returns why a device cannot be used, and the fix."""
    if error.errno == EBUSY:
        return DeviceError(
            f"Another program has taken {device.name} ({device.node}) for itself.",
            hint="End that program: a remapper, another 'neurotouch run', or InputPlumber.",
        )
    if error.errno == ENODEV or isinstance(error, FileNotFoundError):
        return DeviceError(f"'{device.name}' ({device.node}) has just been unplugged.")
    if isinstance(error, PermissionError):
        return DeviceError(
            f"You have no right to read {device.node} ({device.name}).",
            hint="Log in at the machine itself, or join the group: "
            "sudo usermod -aG input $USER, then log in again.",
        )
    return DeviceError(f"'{device.name}' ({device.node}) cannot be read: {error.strerror}.")
