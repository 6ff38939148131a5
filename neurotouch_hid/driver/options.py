"""The options of a driver."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from numbers import Integral, Real
from typing import Final, Literal, get_args

from neurotouch_hid.errors import require_type
from neurotouch_hid.vocabulary import Speed

DeviceKind = Literal["uinput", "hid", "memory"]

_WHETHER: Final = (bool, "True or False")
_TYPES: Final[dict[str, tuple[type, str]]] = {
    "source": (str, "a text such as 'sim:tour'"),
    "profile": (str, "a name or path such as 'spacecraft'"),
    "device": (str, "a text such as 'memory'"),
    "identity": (str, "a text such as 'xbox360'"),
    "copilot": (str, "a text, the name of a device"),
    "player": (Integral, "a whole number from 1 to 4"),
    "speed": (str, "a text such as 'max'"),
    "rate_hz": (Real, "a number such as 250"),
    "method": (str, "a text such as 'neurotouch'"),
    "gel": (str, "a name or path such as 'own.gel.yaml'"),
    "seed": (Integral, "a whole number such as 0"),
    "shows_rumble": _WHETHER,
    "wait": _WHETHER,
    "needs_device": _WHETHER,
    "personal": _WHETHER,
    "listens": _WHETHER,
}
"""Type of each option, and what an error says that it must be."""
_RATES_HZ: Final = (25, 1000)


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
        rate_hz: slices a second, 25 to 1000; None means the usual rate of the source.
        method: the recogniser.
        gel: name or path of the gel's file; None means the one of the recording or of the person,
            ``paper`` the gel of the paper.
        seed: the seed of the simulation, 0 or more.
        shows_rumble: the pad claims to rumble although only the live view shows it.
        wait: neither the camera nor the co-pilot's device needs to be there yet.
        needs_device: without the right to make a gamepad the driver fails; otherwise it goes on
            without one.
        personal: the person's own values apply; otherwise those of the reference hand.
        listens: the driver takes commands, hotkeys, viewers and recorders while it runs; one driver
            of a player at a time. None means always, except at ``max`` speed without a gamepad.

    Raises:
        TypeError: an option has the wrong type.
        ValueError: an option has an impossible value.
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
    gel: str | None = None
    seed: int = 0
    shows_rumble: bool = False
    wait: bool = False
    needs_device: bool = True
    personal: bool = True
    listens: bool | None = None

    def __post_init__(self) -> None:
        for option in fields(self):
            value = getattr(self, option.name)
            if value is not None or option.default is not None:
                require_type(option.name, value, *_TYPES[option.name])
        _require_one("device", self.device, get_args(DeviceKind))
        _require_one("player", self.player, (1, 2, 3, 4))
        _require_one("speed", self.speed, get_args(Speed))
        least, most = _RATES_HZ
        if self.rate_hz is not None and not least <= self.rate_hz <= most:
            raise ValueError(f"rate_hz must be from {least} to {most}, not {self.rate_hz!r}")
        if self.seed < 0:
            raise ValueError(f"seed must be 0 or more, not {self.seed!r}")

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


def _require_one(name: str, value: object, choices: Sequence[object]) -> None:
    if value not in choices:
        *others, last = map(repr, choices)
        raise ValueError(f"{name} must be {', '.join(others)} or {last}, not {value!r}")


REFERENCE: Final = DriverOptions(
    profile="default", device="memory", speed="max", personal=False, listens=False
)
"""For measurements: nothing of this person or machine has a part in the result."""
