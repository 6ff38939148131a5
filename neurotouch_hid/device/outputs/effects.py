"""The rumble effects that games upload to a pad, and the sum of those that play."""

import math
from dataclasses import dataclass
from typing import Final

from evdev import ecodes, ff

_FULL: Final = 0xFFFF
_FULL_PERIODIC: Final = 0x7FFF
_LONGEST_S: Final = 30.0
"""Levels are reported again after this time, for effects without an end."""


@dataclass(frozen=True, slots=True)
class Rumble:
    """Strength and length of a rumble that starts now.

    Attributes:
        strong: the heavy, slow motor, 0..1.
        weak: the light, quick motor, 0..1.
        seconds: its length, unless another one replaces it; 0 for no rumble.
    """

    strong: float
    weak: float
    seconds: float


STILL: Final = Rumble(0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class RumbleEffect:
    """One effect that a game has uploaded.

    Attributes:
        strong: 0..1.
        weak: 0..1.
        seconds: length of one playing; infinite if only a stop ends it.
        delay_s: from the play command to the start.
    """

    strong: float
    weak: float
    seconds: float
    delay_s: float

    @classmethod
    def read(cls, effect: ff.Effect) -> "RumbleEffect":
        """Returns the effect that a game describes; one of an unknown kind does not shake."""
        strong = weak = 0.0
        if effect.type == ecodes.FF_RUMBLE:
            motors = effect.u.ff_rumble_effect
            strong, weak = motors.strong_magnitude / _FULL, motors.weak_magnitude / _FULL
        elif effect.type == ecodes.FF_PERIODIC:
            magnitude = abs(effect.u.ff_periodic_effect.magnitude) / _FULL_PERIODIC
            strong = weak = min(magnitude, 1.0)
        length_ms = effect.ff_replay.length
        seconds = length_ms / 1e3 if length_ms else math.inf
        return cls(strong, weak, seconds, effect.ff_replay.delay / 1e3)


class Effects:
    """The effects of a pad; the pad shakes with the sum of those that play.

    All times are in seconds on any clock.
    """

    def __init__(self) -> None:
        self._effects: dict[int, RumbleEffect] = {}
        self._playing: dict[int, tuple[float, float]] = {}  # from when to when, by effect
        self._gain = 1.0

    def upload(self, number: int, effect: RumbleEffect) -> None:
        """Adds or replaces an effect; one that plays continues with the new values."""
        self._effects[number] = effect

    def erase(self, number: int) -> None:
        """Forgets an effect."""
        self._effects.pop(number, None)
        self._playing.pop(number, None)

    def play(self, number: int, n_times: int, now: float) -> None:
        """Plays an effect ``times`` times in a row; 0 stops it."""
        effect = self._effects.get(number)
        if effect is None or n_times <= 0:
            self._playing.pop(number, None)
        else:
            begin = now + effect.delay_s
            self._playing[number] = begin, begin + n_times * effect.seconds

    def set_gain(self, gain: float) -> None:
        """Sets the strength of all effects, 0..1."""
        self._gain = gain

    def sum_up(self, now: float) -> tuple[Rumble, float]:
        """Returns the present rumble, and the time at which it may change by itself."""
        self._playing = {number: span for number, span in self._playing.items() if span[1] > now}
        sounding = [
            self._effects[number] for number, span in self._playing.items() if span[0] <= now
        ]
        turns = [at for span in self._playing.values() for at in span if at > now]
        until = min([now + _LONGEST_S, *turns])
        strong, weak = (
            min(self._gain * sum(motor), 1.0)
            for motor in (
                [effect.strong for effect in sounding],
                [effect.weak for effect in sounding],
            )
        )
        if strong == weak == 0.0:
            return STILL, until if turns else math.inf
        return Rumble(strong, weak, until - now), until
