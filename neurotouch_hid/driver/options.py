"""The options of a driver."""

from dataclasses import dataclass
from typing import Final, Literal

from neurotouch_hid.source import Speed

DeviceKind = Literal["uinput", "hid", "memory"]


@dataclass(frozen=True, slots=True, kw_only=True)
class DriverOptions:
    """The options of one driver; the defaults play the first camera into a real gamepad.

    Attributes:
        source: the source as a person writes it: ``davis:``, ``file:NAME.aedat4``, ``sim:NAME``.
        profile: name or path of the profile; None means the first of the person's favourites.
        device: ``uinput`` makes a gamepad, ``hid`` a true HID gamepad, ``memory`` none.
        identity: the controller model to emulate; None means the usual one of the device.
        copilot: the physical device that plays along; None means the one in ``driver.yaml``, an
            empty text none.
        player: the player number, 1 to 4; it chooses the files of the person and the sockets.
        speed: ``recorded`` plays as recorded, ``max`` as fast as possible.
        rate_hz: slices a second; None means the usual rate of the source.
        method: the recogniser.
        seed: the seed of whatever is simulated.
        shows_rumble: the pad claims to rumble although only the live view shows it.
        wait: neither the camera nor the co-pilot's device needs to be there yet.
        needs_device: without the right to make a gamepad the driver fails; otherwise it goes on
            without one.
        personal: the person's own values apply; otherwise those of the reference hand.
        listens: the driver takes commands, hotkeys, viewers and recorders while it runs; one driver
            of a player at a time. None means always, except at ``max`` speed without a gamepad.
    """

    source: str = "davis:"
    profile: str | None = None
    device: DeviceKind = "uinput"
    identity: str | None = None
    copilot: str | None = None
    player: int = 1
    speed: Speed = "recorded"
    rate_hz: float | None = None
    method: str = "neurotouch"
    seed: int = 0
    shows_rumble: bool = False
    wait: bool = False
    needs_device: bool = True
    personal: bool = True
    listens: bool | None = None

    @property
    def is_listening(self) -> bool:
        """True if the driver takes commands while it runs."""
        if self.listens is None:
            return self.speed == "recorded" or self.device != "memory"
        return self.listens

    @property
    def slice_us(self) -> int | None:
        """The length of a slice in µs; None for the usual one of the source."""
        return None if self.rate_hz is None else round(1e6 / self.rate_hz)


REFERENCE: Final = DriverOptions(
    profile="default", device="memory", speed="max", personal=False, listens=False
)
"""For measurements: nothing of this person or machine has a part in the result."""
