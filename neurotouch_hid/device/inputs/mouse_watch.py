"""Notices when a person moves the real mouse, so that our pointer can wait."""

import os
import selectors
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import Final

from evdev import InputDevice, ecodes

from neurotouch_hid.device.inputs.nodes import Input, find_inputs

RULE: Final = 'KERNEL=="event*", SUBSYSTEM=="input", ENV{ID_INPUT_MOUSE}=="1", TAG+="uaccess"'
"""The udev rule that lets the person at the machine read its mice."""

_SEARCH_S: Final = 2.0
_MOTIONS: Final = (ecodes.REL_X, ecodes.REL_Y, ecodes.REL_WHEEL)


class MouseWatch:
    """Reads all mice but our own, beside other readers; new ones within two seconds."""

    def __init__(self) -> None:
        self._moved_at = -1e9
        self._mice: list[Input] = []
        self._open: dict[Path, InputDevice] = {}
        self._selector = selectors.DefaultSelector()
        self._wake_read, self._wake_write = os.pipe2(os.O_CLOEXEC | os.O_NONBLOCK)
        self._selector.register(self._wake_read, selectors.EVENT_READ)
        self._find_new()
        self._thread = threading.Thread(target=self._run, name="mouse watch", daemon=True)
        self._thread.start()

    @property
    def quiet_s(self) -> float:
        """Time since a mouse last moved or clicked."""
        return time.monotonic() - self._moved_at

    def describe(self) -> str:
        """Returns which mice are watched, and the fix if they cannot be."""
        names = [mouse.name for mouse in self._mice if mouse.readable]
        if names:
            return f"the pointer waits while {', '.join(names)} moves"
        if not self._mice:
            return "no mouse is plugged in"
        return (
            f"the pointer does not wait for the mouse: this user may not read "
            f"{self._mice[0].node}. The rule that allows it: {RULE}"
        )

    def close(self) -> None:
        """Ends the thread. A second call does nothing."""
        if not self._thread.is_alive():
            return
        os.write(self._wake_write, b"x")
        self._thread.join()
        for mouse in self._open.values():
            mouse.close()
        self._selector.close()
        os.close(self._wake_read)
        os.close(self._wake_write)

    def _run(self) -> None:
        due = time.monotonic() + _SEARCH_S
        while True:
            for key, _ in self._selector.select(max(due - time.monotonic(), 0.0)):
                if key.fd == self._wake_read:
                    return
                self._read(key.data)
            if time.monotonic() >= due:
                self._find_new()
                due = time.monotonic() + _SEARCH_S

    def _find_new(self) -> None:
        self._mice = [each for each in find_inputs() if _is_mouse(each)]
        for mouse in self._mice:
            if mouse.readable and mouse.node not in self._open:
                # It is gone again, as the next search will find; or evdev cannot read its name.
                with suppress(OSError, UnicodeDecodeError):
                    opened = InputDevice(mouse.node)
                    self._open[mouse.node] = opened
                    self._selector.register(opened.fd, selectors.EVENT_READ, opened)

    def _read(self, mouse: InputDevice) -> None:
        try:
            for event in mouse.read():
                if event.type == ecodes.EV_KEY or (
                    event.type == ecodes.EV_REL and event.code in _MOTIONS
                ):
                    self._moved_at = time.monotonic()
        except BlockingIOError:
            return
        except OSError:
            self._selector.unregister(mouse.fd)
            self._open.pop(Path(mouse.path), None)
            mouse.close()


def _is_mouse(device: Input) -> bool:
    return bool(device.motions >> ecodes.REL_X & 1 and device.keys >> ecodes.BTN_LEFT & 1)
