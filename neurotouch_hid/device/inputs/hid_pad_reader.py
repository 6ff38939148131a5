"""Reads the reports of our own HID pads as other programs do, through hidapi."""

import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import hidraw

from neurotouch_hid.device.outputs.descriptor import ReportFormat
from neurotouch_hid.device.outputs.gamepad import ControlLayout
from neurotouch_hid.device.outputs.identity import load_identities
from neurotouch_hid.device.outputs.opening import explain_rule
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import Axis, Button

NODES: Final = Path("/dev")
SYSTEM: Final = Path("/sys/class/hidraw")

_RULES_FILE: Final = "70-neurotouch-hidraw.rules"
"""Not the file of the rule for uhid: a person who follows both hints needs both rules."""

_LONGEST: Final = 64
_TURN_MS: Final = 200
"""A read ends after this time without a report, so that Ctrl-C works."""


@dataclass(frozen=True, slots=True)
class HidPad:
    """A HID pad with our report format, made by any process.

    Attributes:
        node: its hidraw node.
        name: its name.
        place: its physical path, as the device states it.
        ids: bus, vendor and product, as the kernel writes them: ``0003:1209:4E54``.
        layout: its controls.
    """

    node: Path
    name: str
    place: str
    ids: str
    layout: ControlLayout


@dataclass(frozen=True, slots=True)
class Report:
    """Content of one report: the buttons that are down, and the axes that are off their rest."""

    buttons: frozenset[Button]
    axes: dict[Axis, float]


def find_hid_pads(nodes: Path = NODES, system: Path = SYSTEM) -> list[HidPad]:
    """Returns all HID pads with a descriptor of ours, without opening one."""
    ours = {
        ReportFormat(identity.layout.controls).descriptor: identity.layout
        for identity in load_identities().values()
    }
    found = []
    for entry in sorted(system.glob("hidraw*")):
        try:
            layout = ours.get((entry / "device/report_descriptor").read_bytes())
            lines = (entry / "device/uevent").read_text(errors="replace").splitlines()
        except OSError:
            continue  # unplugged meanwhile
        if layout is None:
            continue
        facts = dict(line.split("=", 1) for line in lines if "=" in line)
        ids = ":".join(word[-4:] for word in facts.get("HID_ID", "").split(":"))
        name, place = (
            "".join(char for char in facts.get(key, "") if char.isprintable())
            for key in ("HID_NAME", "HID_PHYS")
        )
        found.append(HidPad(nodes / entry.name, name, place, ids, layout))
    return found


def read_reports(pad: HidPad) -> Iterator[Report | None]:
    """Opens a pad and returns its reports, from now on, as they come.

    Returns:
        Each report, None after a while without one; ends when the pad goes.

    Raises:
        DeviceError: it cannot be read.
    """
    return read_reports_of(_open(pad), pad.layout)


def read_reports_of(device: "hidraw.device", layout: ControlLayout) -> Iterator[Report | None]:
    """Returns the reports of an opened device, which it closes; leaves out those of other lengths.

    Args:
        device: has a descriptor of ours.
        layout: its controls.
    """
    form = ReportFormat(layout.controls)
    try:
        while True:
            try:
                data = device.read(_LONGEST, timeout_ms=_TURN_MS)
            except OSError:
                return  # the pad is gone
            if not data:
                yield None
                continue
            with suppress(ValueError):  # another program may copy the descriptor, not the length
                yield Report(*layout.decode(form.unpack(bytes(data))))
    finally:
        device.close()


def _open(pad: HidPad) -> "hidraw.device":
    if not os.access(pad.node, os.R_OK | os.W_OK):
        rule = f'KERNEL=="hidraw*", SUBSYSTEM=="hidraw", KERNELS=="{pad.ids}.*", TAG+="uaccess"'
        raise DeviceError(
            f"You have no right to read {pad.node} ({pad.name}).",
            hint=explain_rule(rule, _RULES_FILE, "--subsystem-match=hidraw"),
        )
    device = hidraw.device()
    try:
        device.open_path(os.fsencode(pad.node))
    except OSError as error:
        raise DeviceError(f"'{pad.node}' cannot be read: {error}.") from None
    return device
