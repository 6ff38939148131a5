"""Sends neutral when the pipeline has stopped or the machine has slept."""

import threading
import time
from contextlib import suppress

from neurotouch_hid.closing import Closing
from neurotouch_hid.device import Device
from neurotouch_hid.errors import DeviceError

STALL_S = 0.2
"""The pad goes neutral after this silence of the source: twenty slices of 10 ms."""
LIVE_STALL_S = 0.08
"""The same for a camera, which sends something at least every 33 ms, and whose unplugging must show
within 100 ms. Recordings and simulations have no such beat."""


class StallGuard(Closing):
    """Sends neutral when no step has been finished for too long, or when the machine has slept.

    Args:
        device: the pad.
        stall_s: the longest time of a step, waiting for the source included.
    """

    def __init__(self, device: Device, stall_s: float) -> None:
        self._device = device
        self._stall_s = stall_s
        self._fed = time.monotonic()
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="stall guard", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Ends the watch."""
        self._done.set()
        self._thread.join()

    def feed(self) -> None:
        """Reports a finished step."""
        self._fed = time.monotonic()

    def _watch(self) -> None:
        asleep, wait_s = _time_asleep(), self._stall_s
        while not self._done.wait(wait_s):
            slept = _time_asleep() - asleep > self._stall_s
            if slept:
                asleep = _time_asleep()
            left_s = self._fed + self._stall_s - time.monotonic()
            if slept or left_s <= 0:
                with suppress(DeviceError):  # the next write of the pipeline reports it
                    self._device.neutral()
            wait_s = left_s if left_s > 0 else self._stall_s


def _time_asleep() -> float:
    """Returns the seconds that the machine has spent in suspend since boot."""
    return time.clock_gettime(time.CLOCK_BOOTTIME) - time.clock_gettime(time.CLOCK_MONOTONIC)
