"""Settings of a strobed LED ring."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class StrobeConfig:
    """An LED ring that goes off at regular times.

    Attributes:
        hz: how often a second it goes off.
        dark_us: for how long.
    """

    hz: float = 20.0
    dark_us: int = 1_500
