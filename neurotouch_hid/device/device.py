"""What every device can do, and the way to get one by its name."""

import os
from collections.abc import Iterable
from types import TracebackType
from typing import Protocol, Self

from neurotouch_hid.device.outputs.composite import CompositeDevice
from neurotouch_hid.device.outputs.identity import choose_identity, load_identities
from neurotouch_hid.device.outputs.memory import MemoryDevice
from neurotouch_hid.device.outputs.rumble import HearRumble
from neurotouch_hid.device.outputs.spec import ExtraDevice
from neurotouch_hid.device.outputs.uhid import open_uhid
from neurotouch_hid.device.outputs.uinput import open_uinput
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import GamepadState


class Device(Protocol):
    """A pad, and what comes with it, to be pressed. All calls may come from any thread."""

    @property
    def name(self) -> str:
        """What the user is told it is."""

    def prepare(self, extra_devices: Iterable[ExtraDevice]) -> None:
        """Makes those of the extra devices that are missing; call it with each new profile.

        Raises:
            DeviceError: they cannot be made.
        """

    def write(self, state: GamepadState) -> None:
        """Shows everything in this state; one that changes nothing costs nothing.

        Raises:
            DeviceError: the state cannot be written.
        """

    def neutral(self) -> None:
        """Releases everything now. Harmless when nothing is pressed or the device is closed."""

    def close(self) -> None:
        """Releases everything and takes the pad away. Harmless when repeated."""

    def __enter__(self) -> Self:
        """Returns the device itself."""

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Closes the device."""


def check_device(kind: str, identity: str | None = None) -> None:
    """Finds out whether ``open_device`` may succeed, without making a pad.

    Raises:
        DeviceError: the identity is no good, or ``/dev/uinput`` or ``/dev/uhid`` cannot be used.
    """
    match kind:
        case "uinput":
            choose_identity(identity, kind)
            os.close(open_uinput())
        case "hid":
            choose_identity(identity, kind)
            os.close(open_uhid())
        case _:
            choose_identity(identity, "uinput")  # a name is a name, even where no pad is made


def open_device(
    kind: str,
    extra_devices: Iterable[ExtraDevice] = (),
    *,
    identity: str | None = None,
    player: int = 1,
    hear_rumble: HearRumble | None = None,
) -> Device:
    """Returns a new, neutral device of a kind: ``uinput``, ``hid`` (real ones) or ``memory``.

    Args:
        kind: its name.
        extra_devices: what is needed beside the pad.
        identity: what the pad claims to be: a shipped name, or the path of a file.
        player: whose pad it is, from 1 on.
        hear_rumble: is told how games shake the pad; without, it does not claim to rumble.

    Raises:
        DeviceError: the kind or the identity is unknown, programs would misread it, or
            ``/dev/uinput`` or ``/dev/uhid`` cannot be used.
    """
    match kind:
        case "memory":
            return MemoryDevice(extra_devices)
        case "uinput" | "hid":
            return CompositeDevice(
                extra_devices,
                kind=kind,
                identity=choose_identity(identity, kind),
                player=player,
                hear_rumble=hear_rumble,
            )
    raise DeviceError(f"There is no device called {kind!r}.", hint="Use uinput, hid or memory.")


def shows_change(before: GamepadState, after: GamepadState) -> bool:
    """Says whether a pad of the usual layout shows two states differently."""
    layout = load_identities()["xbox360"].layout
    return layout.encode(before) != layout.encode(after)
