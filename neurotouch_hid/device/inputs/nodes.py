"""The input devices of this machine as the kernel lists them, without opening one."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from evdev import ecodes

NODES: Final = Path("/dev/input")
SYSTEM: Final = Path("/sys/class/input")
OURS: Final = "neurotouch/"
"""The physical path of our own devices starts with this."""

_WORD_BITS: Final = 64
_FACTS: Final = ("name", "phys", "uniq")


@dataclass(frozen=True, slots=True)
class Input:
    """An event node.

    Attributes:
        node: where it is.
        name: name of the device.
        phys: its physical path, as the device states it.
        uniq: its serial number, if it has one.
        vendor: its vendor id.
        product: its product id.
        keys: its keys and buttons, a bit for each code.
        axes: its absolute axes, likewise.
        motions: its relative axes, likewise.
        effects: its force feedback, likewise.
    """

    node: Path
    name: str
    phys: str
    uniq: str
    vendor: int
    product: int
    keys: int
    axes: int
    motions: int
    effects: int

    @property
    def readable(self) -> bool:
        """True if this user may read it now."""
        return os.access(self.node, os.R_OK)


def find_inputs(nodes: Path = NODES, system: Path = SYSTEM) -> list[Input]:
    """Returns all event nodes but our own."""
    found = []
    for entry in sorted(system.glob("event*"), key=lambda entry: int(entry.name[5:] or 0)):
        device, node = entry / "device", nodes / entry.name
        try:
            name, phys, uniq = (_read_text(device / file) for file in _FACTS)
            vendor, product = (_read_number(device / "id" / file) for file in ("vendor", "product"))
            keys, axes, motions, effects = (
                parse_bits((device / "capabilities" / kind).read_text())
                for kind in ("key", "abs", "rel", "ff")
            )
        except (OSError, ValueError):
            continue  # gone while we look
        if not phys.startswith(OURS) and node.exists():
            bits = keys, axes, motions, effects
            found.append(Input(node, name, phys, uniq, vendor, product, *bits))
    return found


def is_input_name(name: str) -> bool:
    """Returns True if the kernel has a key or button of this name, for example ``KEY_SPACE``."""
    return name.startswith(("KEY_", "BTN_")) and name in ecodes.ecodes


def parse_bits(text: str) -> int:
    """Returns a bitmap of the kernel, words of hexadecimal digits, as one number."""
    bits = 0
    for word in text.split():
        bits = bits << _WORD_BITS | int(word, 16)
    return bits


def _read_text(file: Path) -> str:
    # A device may have any name; this one is printed on a terminal.
    text = file.read_text(errors="replace") if file.exists() else ""
    return "".join(char for char in text.strip() if char.isprintable())


def _read_number(file: Path) -> int:
    return int(file.read_text(), 16)
