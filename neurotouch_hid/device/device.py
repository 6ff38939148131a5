"""Interface of all devices, and ``open_device``, which opens one by its name."""

import os
from collections.abc import Iterable
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
    """A virtual pad with its keyboard and mouse. Any thread may make any call."""

    @property
    def name(self) -> str:
        """The name that the user sees."""

    def prepare(self, extra_devices: Iterable[ExtraDevice]) -> None:
        """Creates the extra devices that are still missing; call it with each new profile.

        Raises:
            DeviceError: they cannot be made.
        """

    def write(self, state: GamepadState) -> None:
        """Writes this state; a state without a change costs nothing.

        Raises:
            DeviceError: the state cannot be written.
        """

    def neutral(self) -> None:
        """Releases everything now; does nothing if nothing is pressed or the device is closed."""

    def close(self) -> None:
        """Releases everything and removes the pad. A second call does nothing."""

    def __enter__(self) -> Self:
        """Returns the device itself."""

    def __exit__(self, *_: object) -> None:
        """Closes the device."""


def check_device(kind: str, identity: str | None = None) -> None:
    """Checks whether ``open_device`` can succeed, without creating a pad.

    Raises:
        DeviceError: the identity is invalid or has no effect, or ``/dev/uinput`` or ``/dev/uhid``
            cannot be used.
    """
    match kind:
        case "uinput":
            choose_identity(identity, kind)
            os.close(open_uinput())
        case "hid":
            choose_identity(identity, kind)
            os.close(open_uhid())
        case _ if identity is not None:
            choose_identity(identity, "uinput")  # a wrong name is told first
            raise DeviceError(
                f"The device {kind} has no controller model, so '{identity}' has no effect.",
                hint="Leave out --identity, or choose --device uinput or hid.",
            )


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
        extra_devices: the devices needed beside the pad.
        identity: the controller model to emulate: a shipped name, or the path of a file.
        player: number of the player, from 1.
        hear_rumble: called when games shake the pad; if None, the pad does not offer rumble.

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
    """Returns True if two states differ on a pad of the usual layout."""
    layout = load_identities()["xbox360"].layout
    return layout.encode(before) != layout.encode(after)
