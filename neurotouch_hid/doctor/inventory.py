"""Lists game controllers and running programs, as Linux shows them, without opening anything."""

import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from neurotouch_hid import client as driver
from neurotouch_hid.errors import DriverError
from neurotouch_hid.status import Status

OURS: Final = "neurotouch/"
"""The physical path of our own devices starts with this."""

_INPUT: Final = Path("/sys/class/input")
_NODES: Final = Path("/dev/input")
_PROCESSES: Final = Path("/proc")
_BTN_JOYSTICK: Final = 0x120
_BTN_DIGI: Final = 0x140
_WORD_BITS: Final = 64
_INTERPRETERS: Final = ("python", "perl", "ruby", "node", "sh", "bash")
"""Interpreters: their first argument is the program that they run."""


@dataclass(frozen=True, slots=True)
class Pad:
    """A game controller.

    Attributes:
        node: its event node.
        name: its name.
        ids: bus, vendor, product and version.
        place: its physical path, as the device states it.
        virtual: a program has made it.
        ours: this program has made it.
        readable: this user may read it.
    """

    node: str
    name: str
    ids: tuple[int, int, int, int]
    place: str
    virtual: bool
    ours: bool
    readable: bool

    @property
    def usb_id(self) -> str:
        """Vendor and product, as usual."""
        return f"{self.ids[1]:04x}:{self.ids[2]:04x}"


@dataclass(frozen=True, slots=True)
class Process:
    """A running program: its number and its name."""

    pid: int
    name: str


def find_pads(system: Path = _INPUT, nodes: Path = _NODES) -> tuple[Pad, ...]:
    """Returns all game controllers, in the order of their nodes."""
    found = []
    for entry in sorted(system.glob("event*"), key=lambda path: int(path.name[5:])):
        with suppress(OSError, ValueError):  # unplugged while we look
            pad = _read_pad(entry, nodes / entry.name)
            if pad is not None:
                found.append(pad)
    return tuple(found)


def _read_pad(entry: Path, node: Path) -> Pad | None:
    device = entry / "device"
    keys = 0
    for word in (device / "capabilities" / "key").read_text().split():
        keys = keys << _WORD_BITS | int(word, 16)
    if not any(keys >> code & 1 for code in range(_BTN_JOYSTICK, _BTN_DIGI)):
        return None
    if not int((device / "capabilities" / "abs").read_text().split()[-1], 16) & 0b11:
        return None  # no stick: a mouse or keyboard with odd buttons
    ids = [int((device / "id" / name).read_text(), 16) for name in _IDS]
    place = _clean(device / "phys")
    return Pad(
        node=str(node),
        name=_clean(device / "name"),
        ids=(ids[0], ids[1], ids[2], ids[3]),
        place=place,
        virtual="/devices/virtual/" in str(entry.resolve()),
        ours=place.startswith(OURS),
        readable=os.access(node, os.R_OK),
    )


_IDS: Final = ("bustype", "vendor", "product", "version")


def _clean(file: Path) -> str:
    """Returns the text of a device, made safe for a terminal."""
    text = file.read_text(errors="replace").strip()
    return "".join(char for char in text if char.isprintable())


def find_processes(names: set[str]) -> tuple[Process, ...]:
    """Returns the running programs with one of these names, by command or by script."""
    found = []
    for folder in _PROCESSES.glob("[0-9]*"):
        with suppress(OSError):  # it has ended
            for name in _list_names(folder):
                if name in names:
                    found.append(Process(int(folder.name), name))
                    break
    return tuple(sorted(found, key=lambda process: process.pid))


def _list_names(folder: Path) -> Iterator[str]:
    yield (folder / "comm").read_text(errors="replace").strip()
    words = (folder / "cmdline").read_text(errors="replace").split("\0")
    program = Path(words[0]).name
    yield program
    if program.startswith(_INTERPRETERS) and len(words) > 1:
        yield Path(words[1]).name


def find_driver() -> Status | None:
    """Returns the running driver's status; None if none runs or it does not answer."""
    try:
        return driver.ask_status()
    except DriverError:
        return None
