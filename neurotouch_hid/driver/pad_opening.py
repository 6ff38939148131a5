"""The pad of a running driver: what games see, and everybody who plays on it."""

from collections.abc import Callable, Iterable
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any

from neurotouch_hid.device import (
    Copilot,
    Device,
    ExtraDevice,
    RumbleRouter,
    SharedDevice,
    open_device,
)
from neurotouch_hid.driver.settings import DriverSettings


@dataclass(frozen=True, slots=True)
class DriverPad:
    """A pad and who plays on it.

    Attributes:
        device: what the pipeline writes to.
        copilot: the physical device that plays along, if there is one.
        rumble: how games shake it.
    """

    device: SharedDevice
    copilot: Copilot | None
    rumble: RumbleRouter

    @property
    def facts(self) -> dict[str, Callable[[], Any]]:
        """What viewers are told."""
        copilot = self.copilot
        return {
            "copilot": copilot.describe if copilot else lambda: "none",
            "mouse": self.device.describe_mouse,
            "rumble": self.rumble.describe,
        }


def open_pad(
    kind: str,
    extra_devices: Iterable[ExtraDevice],
    settings: DriverSettings,
    *,
    identity: str | None = None,
    player: int = 1,
    copilot: str | None = None,
    shows_rumble: bool = False,
    wait: bool = False,
    make: Callable[..., Device] = open_device,
) -> DriverPad:
    """Returns a new, neutral pad on which the gel plays, and a co-pilot if one is wanted.

    Games may shake it only if something can rumble: the co-pilot's device, or a viewer who watches
    on. A pad that claims to rumble and does not would keep games from saying so.

    Args:
        kind: ``uinput``, ``hid`` or ``memory``.
        extra_devices: what is needed beside the pad.
        settings: of the driver on this machine.
        identity: what the pad claims to be.
        player: whose pad it is, from 1 on.
        copilot: which device plays along; None means as the settings say, an empty text none.
        shows_rumble: a viewer wants to see the rumble.
        wait: the co-pilot's device need not be there yet.
        make: makes the device; called as ``open_device`` is.

    Raises:
        DeviceError: the pad cannot be made, or the co-pilot's device cannot be taken.
    """
    wanted = settings.copilot.device if copilot is None else copilot
    helper = Copilot(wanted, settings.copilot.keys, wait=wait) if wanted else None
    can_rumble = helper is not None and helper.rumbles
    board = RumbleRouter(*([helper.shake] if helper is not None and can_rumble else []))
    with ExitStack() as closing:  # of what is there, if the rest fails
        if helper is not None:
            closing.callback(helper.close)
        hear = board.hear if can_rumble or shows_rumble else None
        device = make(kind, extra_devices, identity=identity, player=player, hear_rumble=hear)
        shared = SharedDevice(
            device,
            helper,
            priority=settings.copilot.priority,
            yield_to_mouse_s=settings.yield_to_mouse_ms / 1e3,
        )
        shared.prepare(extra_devices)
        closing.pop_all()
    return DriverPad(shared, helper, board)
