"""Gestures written as text, for trying a profile without a gel: ``push left 5mm 300ms hold 1s``.

One step a line, or several with ``;`` between them; ``#`` begins a comment. A step is

    rest TIME
    GESTURE [WAY] [AMOUNT] [TIME] [hold TIME] [release TIME] [tap] [fingers N] [at X Y]
            [tremor FREQUENCY AMOUNT]

GESTURE is push, pinch, zoom, twist_cw or twist_ccw; WAY is left, right, up, down, a diagonal such
as up_left, or an angle such as 30deg (0 right, 90 towards the user). AMOUNT is in mm, TIME in ms or
s, FREQUENCY in Hz, X and Y in mm from the middle of the gel. The first time is that of the rise and
of the fall; ``tap`` makes everything quick. A hand rises and falls with least jerk.
"""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.faults import suggest
from neurotouch_hid.messages import Gesture, GestureKind
from neurotouch_hid.printable import make_printable
from neurotouch_hid.profile.schema.targets import EightWay

SLICE_US: Final = 10_000
GATE_MM: Final = 0.16
"""Below this the recognizer says that nothing is there."""

MAX_STEPS: Final = 1000
MAX_TIME_US: Final = 600_000_000
_TAP_US: Final = 40_000
_ANGLES: Final[dict[EightWay, float]] = {
    "right": 0.0,
    "down_right": 45.0,
    "down": 90.0,
    "down_left": 135.0,
    "left": 180.0,
    "up_left": 225.0,
    "up": 270.0,
    "up_right": 315.0,
}
_KINDS: Final = {kind.label: kind for kind in GestureKind if kind != GestureKind.NONE}
_TWO_WORDS: Final = re.compile(r"\btwist[ -](c?cw)\b")
_TOKEN: Final = re.compile(r"([+-]?\d+(?:\.\d+)?)\s*(mm|ms|s|hz|deg)?\b|([a-z_]+)|(\S)")
_UNITS_US: Final = {"ms": 1e3, "s": 1e6}

Token = tuple[str, float]
"""A word and 0, or a unit (empty if there is none) and its number."""


@dataclass(slots=True)
class ScriptStep:
    """One gesture, or a rest: how far, how long, where."""

    kind: GestureKind = GestureKind.NONE
    angle_deg: float = 0.0
    amount_mm: float = 5.0
    rise_us: int = 150_000
    hold_us: int = 100_000
    fall_us: int = 150_000
    fingers: int = 1
    at_mm: tuple[float, float] = (0.0, 0.0)
    tremor: tuple[float, float] = (0.0, 0.0)

    @property
    def length_us(self) -> int:
        """The duration of the step."""
        return self.rise_us + self.hold_us + self.fall_us

    def measure_mm(self, t_us: int) -> float:
        """Returns the intensity this long after its beginning."""
        if t_us < self.rise_us:
            level = _ease(t_us / self.rise_us)
        elif t_us < self.rise_us + self.hold_us:
            level = 1.0
        else:
            level = _ease((self.length_us - t_us) / max(self.fall_us, 1))
        frequency_hz, swing_mm = self.tremor
        swing = swing_mm * math.sin(2.0 * math.pi * frequency_hz * t_us * 1e-6)
        return max(0.0, self.amount_mm * level + (swing if level > 0.0 else 0.0))


def rehearse(text: str, *, slice_us: int = SLICE_US) -> Iterator[Gesture]:
    """Gives the gestures a text describes, one a slice, from 0 µs on, ending with 0.3 s of rest.

    Raises:
        ProfileError: the text says something else.
    """
    steps = [*parse_script(text), ScriptStep(rise_us=0, hold_us=300_000, fall_us=0)]
    begin_us, t_us = 0, 0
    for step in steps:
        while t_us < begin_us + step.length_us:
            yield _make_gesture(step, t_us - begin_us, t_us)
            t_us += slice_us
        begin_us += step.length_us


def parse_script(text: str) -> list[ScriptStep]:
    """Returns the steps of a text.

    Raises:
        ProfileError: the text says something else.
    """
    lines = [part for line in text.splitlines() for part in line.partition("#")[0].split(";")]
    steps = [_Parser(line).parse() for line in lines if line.strip()]
    if len(steps) > MAX_STEPS or sum(step.length_us for step in steps) > MAX_TIME_US:
        raise ProfileError("A script of gestures has at most 1000 steps and takes 10 minutes.")
    return steps


@dataclass(slots=True)
class _Parser:
    """Reads one step."""

    line: str
    tokens: list[Token] = field(default_factory=list)

    def parse(self) -> ScriptStep:
        line = _TWO_WORDS.sub(r"twist_\1", self.line.lower())
        for number, unit, word, other in _TOKEN.findall(line):
            if other:
                raise self._refuse(f"'{other}' is not understood")
            self.tokens.append((unit, float(number)) if number else (word, 0.0))
        self.tokens.reverse()
        name = self._take_word()
        if name == "rest":
            return ScriptStep(rise_us=0, hold_us=self._take_us(), fall_us=0)
        if name not in _KINDS:
            raise self._refuse(f"'{name}' is no gesture", suggest(name, [*_KINDS, "rest"]))
        step = ScriptStep(_KINDS[name], fingers=1 if name == "push" else 2)
        timed = False
        while self.tokens:
            word, number = self.tokens[-1]
            if word in _UNITS_US and not timed:
                step.rise_us = step.fall_us = self._take_us()
                timed = True
            elif word == "mm":
                step.amount_mm = self._take(("mm",))
            elif word == "deg":
                step.angle_deg = self._take(("deg",))
            else:
                self._take_option(step, self._take_word())
        return step

    def _take_option(self, step: ScriptStep, word: str) -> None:
        match word:
            case "hold":
                step.hold_us = self._take_us()
            case "release":
                step.fall_us = self._take_us()
            case "tap":
                step.rise_us = step.hold_us = step.fall_us = _TAP_US
            case "fingers":
                step.fingers = min(max(int(self._take(("",))), 1), 3)
            case "at":
                step.at_mm = (self._take(("", "mm")), self._take(("", "mm")))
            case "tremor":
                step.tremor = (self._take(("hz",)), self._take(("mm",)))
            case _ if word in _ANGLES:
                step.angle_deg = _ANGLES[word]
            case _:
                known = [*_ANGLES, "hold", "release", "tap", "fingers", "at", "tremor"]
                raise self._refuse(f"'{word}' is not understood", suggest(word, known))

    def _take_word(self) -> str:
        word, number = self.tokens.pop() if self.tokens else ("", 0.0)
        if word in ("", "mm", "ms", "s", "hz", "deg"):
            raise self._refuse(f"{number:g}{word} is where a word belongs")
        return word

    def _take_us(self) -> int:
        unit = self.tokens[-1][0] if self.tokens else ""
        return round(self._take(("ms", "s")) * _UNITS_US.get(unit, 1.0))

    def _take(self, units: tuple[str, ...]) -> float:
        if not self.tokens or self.tokens[-1][0] not in units:
            raise self._refuse(
                f"a number{' in ' + ' or '.join(units) if units[0] else ''} is missing"
            )
        return self.tokens.pop()[1]

    def _refuse(self, sentence: str, hint: str = "") -> ProfileError:
        line = make_printable(self.line.strip()[:80])
        where = "" if f"'{line}'" in sentence else f", '{line}'"
        return ProfileError(
            f"In the gesture script{where}: {sentence}.",
            hint=hint[:1].upper() + hint[1:] or "For example: push left 5mm 300ms hold 1s",
        )


def _ease(share: float) -> float:
    """Returns the way of least jerk from 0 to 1."""
    return share**3 * (10.0 - 15.0 * share + 6.0 * share * share)


def _make_gesture(step: ScriptStep, since_us: int, t_us: int) -> Gesture:
    mm = 0.0 if step.kind == GestureKind.NONE else step.measure_mm(since_us)
    if mm < GATE_MM:
        nothing = np.zeros((0, 2))
        return Gesture(t_us, GestureKind.NONE, nothing, nothing, 0.0)
    angle = math.radians(step.angle_deg)
    moved = (0.0, 0.0)
    if step.kind == GestureKind.PUSH:
        moved = (mm * math.cos(angle), mm * math.sin(angle))
    around = np.linspace(-8.0, 8.0, step.fingers) if step.fingers > 1 else np.zeros(1)
    contacts = np.column_stack((around, np.zeros(step.fingers))) + step.at_mm + moved
    turns = {GestureKind.TWIST_CW: 1.0, GestureKind.TWIST_CCW: -1.0}
    grows = {GestureKind.ZOOM: 1.0, GestureKind.PINCH: -1.0}
    return Gesture(
        t_us,
        step.kind,
        contacts,
        np.zeros_like(contacts),
        mm,
        moved,
        turns.get(step.kind, 0.0) * mm / 10.0,
        1.0 + grows.get(step.kind, 0.0) * mm / 40.0,
    )
