"""A pad that nobody sees: it remembers what was written, for tests and dry runs."""

from collections import deque
from threading import Lock
from types import TracebackType
from typing import Self

from neurotouch_hid.device.gamepad import NEUTRAL, encode
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import GamepadState


class MemoryDevice:
    """Keeps the states that a real pad would have shown as a change, oldest first.

    Attributes:
        name: what the user is told it is.
        states: the changes; the newest 10 000 (100 s of ceaseless motion), so that a dry run of
            days does not grow.
    """

    name = "memory"

    def __init__(self) -> None:
        self.states: deque[GamepadState] = deque(maxlen=10_000)
        self._report = NEUTRAL
        self._t_us = 0
        self._closed = False
        self._lock = Lock()

    def write(self, state: GamepadState) -> None:
        """Keep the state if it changes the pad.

        Raises:
            DeviceError: the device is closed.
        """
        with self._lock:
            if self._closed:
                raise DeviceError("The virtual gamepad is already closed.")
            self._show(state)

    def neutral(self) -> None:
        """Release everything, at the moment of the state before."""
        with self._lock:
            if not self._closed:
                self._show(GamepadState(self._t_us))

    def close(self) -> None:
        """Release everything and accept nothing more."""
        self.neutral()
        with self._lock:
            self._closed = True

    def __enter__(self) -> Self:
        """Return the device itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the device."""
        self.close()

    def _show(self, state: GamepadState) -> None:
        self._t_us = state.t_us
        report = encode(state)
        if report != self._report:
            self._report = report
            self.states.append(state)
