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
STALL_PERIODS = 2.5
"""The same for a source that sends only pictures: one may be missing, and after three without any
the pad must be neutral."""
FORGOTTEN_S = 10.0
"""After this silence the gesture before it counts no more. A slow machine is silent for less, again
and again, and must still be able to play."""


class StallGuard(Closing):
    """Sends neutral when no step has been finished for too long.

    The time counts in which the machine sleeps, or in which this process is stopped. After a long
    silence, the gesture before it may long be over.

    Args:
        device: the pad.
        stall_s: the longest time of a step, waiting for the source included.

    Attributes:
        stall_s: the same; the thread that feeds may change it.
    """

    def __init__(self, device: Device, stall_s: float) -> None:
        self._device = device
        self.stall_s = stall_s
        self._fed_s = _read_clock_s()
        self._was_silent = False
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="stall guard", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Ends the watch."""
        self._done.set()
        self._thread.join()

    def feed(self) -> None:
        """Reports a finished step."""
        now_s = _read_clock_s()
        self._was_silent |= now_s - self._fed_s >= FORGOTTEN_S
        self._fed_s = now_s

    def give_up(self) -> None:
        """Sends neutral now: the source knows that no step can follow soon.

        Raises:
            DeviceError: the pad takes nothing any more.
        """
        if self._left_s() > 0:
            self._device.neutral()
            self._fed_s -= self.stall_s

    def take_silence(self) -> bool:
        """Returns whether there was a long silence since this was last asked, up to now.

        The pipeline's thread asks: after a silence it may be awake before the thread that sends
        neutral.
        """
        was_silent = self._was_silent or self._is_silent()
        self._was_silent = False
        return was_silent

    def _watch(self) -> None:
        wait_s = self.stall_s
        while not self._done.wait(wait_s):
            left_s = self._left_s()
            if left_s <= 0:
                with suppress(DeviceError):  # the next write of the pipeline reports it
                    self._device.neutral()
            wait_s = left_s if left_s > 0 else self.stall_s

    def _is_silent(self) -> bool:
        return _read_clock_s() - self._fed_s >= FORGOTTEN_S

    def _left_s(self) -> float:
        return self._fed_s + self.stall_s - _read_clock_s()


def _read_clock_s() -> float:
    """Returns host time that goes on while the machine sleeps."""
    return time.clock_gettime(time.CLOCK_BOOTTIME)
