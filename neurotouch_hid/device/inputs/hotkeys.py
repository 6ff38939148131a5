"""Chords: keys held together on a real keyboard stop the gamepad, with any profile.

This module reads the kernel's event nodes, as other programs may do too. If a remapper has grabbed
a keyboard, it reads the keyboard that the remapper makes instead. It never reads our own.
"""

import os
import selectors
import struct
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from evdev import ecodes

from neurotouch_hid.device.inputs.nodes import NODES, OURS, SYSTEM, parse_bits

CHORDS: Final = {
    "panic": ("KEY_BACKSPACE", "KEY_ESC", "KEY_ENTER"),
    "pause": ("KEY_BACKSPACE", "KEY_ESC", "KEY_SPACE"),
}
"""Keys that no program wants together; keyd ends itself at the first of these."""

RULE: Final = 'KERNEL=="event*", SUBSYSTEM=="input", ENV{ID_INPUT_KEYBOARD}=="1", TAG+="uaccess"'
"""The udev rule that lets the person at the machine read its keyboards, in any program."""

_USUAL: Final = [ecodes.ecodes[name] for name in ("KEY_ESC", "KEY_ENTER", "KEY_SPACE")]
"""A device with one of these keys counts as a keyboard; a box with two switches may be one."""

_INPUT_EVENT: Final = struct.Struct("@llHHi")  # seconds, microseconds, type, code, value
_SEARCH_S: Final = 2.0


@dataclass(frozen=True, slots=True)
class KeyboardNode:
    """The event node of a keyboard.

    Attributes:
        node: its event node.
        name: its name.
        readable: this user may read it.
    """

    node: Path
    name: str
    readable: bool


def find_keyboards(nodes: Path = NODES, system: Path = SYSTEM) -> list[KeyboardNode]:
    """Returns all keyboards but our own, without opening one."""
    found = []
    for entry in sorted(system.glob("event*")):
        device, node = entry / "device", nodes / entry.name
        try:
            keys = parse_bits((device / "capabilities" / "key").read_text())
            phys, name = (
                # A device may have any name; this one is printed on a terminal.
                (device / file).read_text(errors="replace").strip()
                for file in ("phys", "name")
            )
        except OSError:
            continue  # gone while we look
        if phys.startswith(OURS) or not any(keys >> code & 1 for code in _USUAL):
            continue
        if node.exists():
            name = "".join(char for char in name if char.isprintable())
            found.append(KeyboardNode(node, name, os.access(node, os.R_OK)))
    return found


def explain_keyboards(keyboards: list[KeyboardNode]) -> tuple[str, str | None]:
    """Returns a sentence on whether chords work, and the fix if they do not."""
    readable = [keyboard.name for keyboard in keyboards if keyboard.readable]
    if readable:
        return f"chords work on {', '.join(readable)}", None
    if not keyboards:
        return "no keyboard is plugged in, so chords do not work", None
    return (
        f"chords do not work: this user may not read {keyboards[0].node} ({keyboards[0].name})",
        "Allow it for the person at the machine, but mind that every program of theirs can then "
        "see what is typed:\n"
        f"  echo '{RULE}' | sudo tee /etc/udev/rules.d/70-neurotouch-keyboard.rules\n"
        "  sudo udevadm control --reload && sudo udevadm trigger --subsystem-match=input",
    )


class ChordReader:
    """Calls back when all keys of a chord are down, on one keyboard or several.

    Keyboards that come later are found within two seconds.

    Args:
        chords: the names of the keys of each chord.
        hear: called with the name of a chord; must return at once.
        nodes: the folder of the event nodes.
        system: the folder in which the kernel describes them.
    """

    def __init__(
        self,
        hear: Callable[[str], object],
        chords: Mapping[str, tuple[str, ...]] = CHORDS,
        *,
        nodes: Path = NODES,
        system: Path = SYSTEM,
    ) -> None:
        self._chords = {
            name: frozenset(ecodes.ecodes[key] for key in keys) for name, keys in chords.items()
        }
        self._hear = hear
        self._nodes, self._system = nodes, system
        self._keyboards: list[KeyboardNode] = []
        self._down: dict[int, set[int]] = {}  # by descriptor
        self._open: dict[Path, int] = {}
        self._held: set[str] = set()
        self._selector = selectors.DefaultSelector()
        self._wake_read, self._wake_write = os.pipe2(os.O_CLOEXEC | os.O_NONBLOCK)
        self._selector.register(self._wake_read, selectors.EVENT_READ)
        self._find_new()
        self._thread = threading.Thread(target=self._read_on, name="chords", daemon=True)
        self._thread.start()

    def describe(self) -> str:
        """Returns whether chords work, and the fix if they do not."""
        return ". ".join(filter(None, explain_keyboards(self._keyboards)))

    def close(self) -> None:
        """Ends the thread and releases the keyboards. A second call does nothing."""
        if not self._thread.is_alive():
            return
        os.write(self._wake_write, b"x")
        self._thread.join()
        for descriptor in (*self._open.values(), self._wake_read, self._wake_write):
            os.close(descriptor)
        self._open.clear()
        self._selector.close()

    def _read_on(self) -> None:
        due = time.monotonic() + _SEARCH_S
        while True:
            for key, _ in self._selector.select(max(due - time.monotonic(), 0.0)):
                if key.fd == self._wake_read:
                    return
                self._read(key.fd)
            if time.monotonic() >= due:
                self._find_new()
                due = time.monotonic() + _SEARCH_S

    def _find_new(self) -> None:
        self._keyboards = find_keyboards(self._nodes, self._system)
        for keyboard in self._keyboards:
            if not keyboard.readable or keyboard.node in self._open:
                continue
            with suppress(
                OSError
            ):  # gone again, or no longer readable, as the next search will find
                flags = os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC | os.O_NOCTTY
                descriptor = os.open(keyboard.node, flags)
                self._open[keyboard.node] = descriptor
                self._down[descriptor] = set()
                self._selector.register(descriptor, selectors.EVENT_READ)

    def _read(self, descriptor: int) -> None:
        try:
            data = os.read(descriptor, 64 * _INPUT_EVENT.size)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self._drop(descriptor)
            return
        down = self._down[descriptor]
        whole = len(data) - len(data) % _INPUT_EVENT.size
        for *_, kind, code, value in _INPUT_EVENT.iter_unpack(data[:whole]):
            if kind == ecodes.EV_SYN and code == ecodes.SYN_DROPPED:
                down.clear()  # releases may be lost; a chord is pressed again
            elif kind == ecodes.EV_KEY and value == 0:
                down.discard(code)
                self._compare()
            elif kind == ecodes.EV_KEY:
                down.add(code)
                self._compare()

    def _compare(self) -> None:
        """Reports each chord once, until one of its keys is released."""
        down = frozenset().union(*self._down.values())
        for name, keys in self._chords.items():
            if not keys <= down:
                self._held.discard(name)
            elif name not in self._held:
                self._held.add(name)
                self._hear(name)

    def _drop(self, descriptor: int) -> None:
        """Forgets a keyboard that is gone, with all keys that were down."""
        self._selector.unregister(descriptor)
        os.close(descriptor)
        del self._down[descriptor]
        self._open = {node: fd for node, fd in self._open.items() if fd != descriptor}
        self._compare()
