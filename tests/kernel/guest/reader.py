"""A program that reads our nodes with plain evdev, as any other would."""

import contextlib
import os
import struct
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import evdev

EVENT = struct.Struct("@llHHi")  # seconds, microseconds, type, code, value


def list_nodes() -> list[str]:
    """Return where our own nodes claim to be plugged in."""
    places = (
        node.read_text().strip() for node in Path("/sys/class/input").glob("event*/device/phys")
    )
    return sorted(place for place in places if place.startswith("neurotouch/"))


def find_node(phys: str, patience_s: float = 120.0) -> evdev.InputDevice:
    """Wait for one of our nodes and return it.

    The kernel lists a device in /sys before its file is in /dev, and takes it away in between.

    Raises:
        TimeoutError: it did not come.
    """
    deadline = time.monotonic() + patience_s
    while time.monotonic() < deadline:
        for node in Path("/sys/class/input").glob("event*"):
            with contextlib.suppress(FileNotFoundError):
                if (node / "device/phys").read_text().strip() == phys:
                    return evdev.InputDevice(f"/dev/input/{node.name}")
        time.sleep(0.05)
    raise TimeoutError(f"{phys} did not appear")


class Reader:
    """Collects everything that a device says, until it disappears.

    Attributes:
        events: (type, code, value) in order, the ends of frames included.
        ended: the error that ended the reading, or None while it lasts.
    """

    def __init__(self, device: evdev.InputDevice) -> None:
        self.events: list[tuple[int, int, int]] = []
        self.ended: str | None = None
        self._device = device
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def wait_for(
        self, condition: Callable[[list[tuple[int, int, int]]], bool], patience_s: float = 60.0
    ) -> None:
        """Wait until the events meet the condition.

        Raises:
            TimeoutError: they did not.
        """
        deadline = time.monotonic() + patience_s
        while not condition(self.events):
            if time.monotonic() > deadline:
                raise TimeoutError(f"only these came: {self.events}")
            time.sleep(0.005)

    def wait_until_quiet(self, quiet_s: float = 0.3, patience_s: float = 60.0) -> None:
        """Wait until nothing has come for some time."""
        deadline = time.monotonic() + patience_s
        n_events = -1
        while n_events != len(self.events) and time.monotonic() < deadline:
            n_events = len(self.events)
            time.sleep(quiet_s)

    def wait_for_end(self, patience_s: float = 60.0) -> None:
        """Wait until the device is gone."""
        self._thread.join(patience_s)

    def report(self) -> dict[str, Any]:
        """Return what was seen, for the file of results."""
        return {
            "events": self.events,
            "ended": self.ended,
            "node_left": Path(self._device.path).exists(),
        }

    def _read(self) -> None:
        # What is unread when the device goes away is lost, so sit in a blocking read, before all
        # others: the events of a killed pad and its end are less than a millisecond apart.
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(10))
        os.set_blocking(self._device.fd, True)
        try:
            while True:
                for _, _, *event in EVENT.iter_unpack(os.read(self._device.fd, 64 * EVENT.size)):
                    self.events.append(tuple(event))
        except OSError as error:
            self.ended = os.strerror(error.errno)
