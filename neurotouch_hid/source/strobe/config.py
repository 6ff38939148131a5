"""Settings of a strobed LED ring."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class StrobeConfig:
    """How the LED ring of an event camera is switched.

    Attributes:
        hz: how often a second it goes off.
        dark_us: for how long.
    """

    hz: float = 20.0
    dark_us: int = 1_500
