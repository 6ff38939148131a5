"""Opens the pad of a driver, the co-pilot who plays on it, and the rumble that games send."""

from collections.abc import Callable, Iterable
from contextlib import ExitStack
from dataclasses import dataclass

from neurotouch_hid.device import (
    Copilot,
    Device,
    ExtraDevice,
    MergedDevice,
    RumbleRouter,
    open_device,
)
from neurotouch_hid.driver.extra_devices import find_extra_devices
from neurotouch_hid.driver.options import DriverOptions
from neurotouch_hid.driver.settings import DriverSettings
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.profile import Profile
from neurotouch_hid.status import PadFacts


@dataclass(frozen=True, slots=True)
class DriverPad:
    """A pad and all who play on it.

    Attributes:
        device: the pipeline writes to it.
        copilot: the physical device that plays along, if there is one.
        rumble: passes on how games shake it.
    """

    device: MergedDevice
    copilot: Copilot | None
    rumble: RumbleRouter

    def tell_facts(self) -> PadFacts:
        """Returns the facts for ``status`` and viewers."""
        return {
            "copilot": self.copilot.describe() if self.copilot else "none",
            "mouse": self.device.describe_mouse(),
            "rumble": self.rumble.describe(),
        }


def open_driver_pad(
    options: DriverOptions,
    profile: Profile,
    settings: DriverSettings,
    *,
    announce: Callable[[str], object],
    make: Callable[..., Device] = open_device,
) -> DriverPad:
    """Returns the pad of the options; one in memory if another is not needed and cannot be made.

    Args:
        options: of the driver.
        profile: the profile at the start.
        settings: of the driver on this machine.
        announce: is told why there is only one in memory.
        make: makes the device; called as ``open_device`` is.

    Raises:
        DeviceError: the pad is needed and cannot be made, or the co-pilot's device cannot be taken.
    """
    try:
        return open_pad(
            options.device,
            find_extra_devices(profile),
            settings,
            identity=options.identity,
            player=options.player,
            copilot=options.copilot,
            shows_rumble=options.shows_rumble,
            wait=options.wait,
            make=make,
        )
    except DeviceError as error:
        if options.needs_device:
            raise
        announce(f"No real controller this time: {error.message} Going on without.")
        return open_pad("memory", (), settings, player=options.player, copilot="")


def open_bare_pad(
    options: DriverOptions, profile: Profile, make: Callable[..., Device] = open_device
) -> Device:
    """Returns the pad of the options, on which only the gel plays."""
    return make(
        options.device,
        find_extra_devices(profile),
        identity=options.identity,
        player=options.player,
    )


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

    Games may shake it only if something can rumble: the co-pilot's device, or a viewer that
    shows it. A pad that claims to rumble and does not would keep games from saying so.

    Args:
        kind: ``uinput``, ``hid`` or ``memory``.
        extra_devices: the devices that are needed beside the pad.
        settings: of the driver on this machine.
        identity: the controller model that the pad claims to be.
        player: the player number, from 1 on.
        copilot: the device that plays along; None means as the settings say, an empty text none.
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
        shared = MergedDevice(
            device,
            helper,
            priority=settings.copilot.priority,
            yield_to_mouse_s=settings.yield_to_mouse_ms / 1e3,
        )
        shared.prepare(extra_devices)
        closing.pop_all()
    return DriverPad(shared, helper, board)
