"""What every device can do, and the way to get one by its name."""

import os
from collections.abc import Iterable
from types import TracebackType
from typing import Protocol, Self

from neurotouch_hid.device.claim import Companion
from neurotouch_hid.device.composite import CompositeDevice
from neurotouch_hid.device.memory import MemoryDevice
from neurotouch_hid.device.uinput import open_uinput
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import GamepadState


class Device(Protocol):
    """A pad, and what stands beside it, to be pressed. All calls may come from any thread."""

    @property
    def name(self) -> str:
        """What the user is told it is."""

    def prepare(self, companions: Iterable[Companion]) -> None:
        """Make those of the companions that are missing; call it with each new profile.

        Raises:
            DeviceError: they cannot be made.
        """

    def write(self, state: GamepadState) -> None:
        """Show everything in this state; one that changes nothing costs nothing.

        Raises:
            DeviceError: the state cannot be written.
        """

    def neutral(self) -> None:
        """Release everything now. Harmless when nothing is pressed or the device is closed."""

    def close(self) -> None:
        """Release everything and take the pad away. Harmless when repeated."""

    def __enter__(self) -> Self:
        """Return the device itself."""

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the device."""


def check_device(kind: str) -> None:
    """Find out whether ``open_device`` may succeed, without making a pad.

    Raises:
        DeviceError: ``/dev/uinput`` cannot be used.
    """
    if kind == "uinput":
        os.close(open_uinput())


def open_device(kind: str, companions: Iterable[Companion] = ()) -> Device:
    """Return a new, neutral device of a kind: ``uinput`` (a real one) or ``memory``.

    Args:
        kind: its name.
        companions: what is needed beside the pad.

    Raises:
        DeviceError: the kind is unknown, or ``/dev/uinput`` cannot be used.
    """
    if kind == "memory":
        return MemoryDevice(companions)
    if kind == "uinput":
        return CompositeDevice(companions)
    raise DeviceError(f"There is no device called {kind!r}.", hint="Use uinput or memory.")
