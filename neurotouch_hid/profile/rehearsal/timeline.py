"""Timeline of a profile's outputs for a stream of gestures, in words."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Final

from neurotouch_hid.messages import GamepadState, Gesture, GestureKind
from neurotouch_hid.profile.engine.regions import choose_direction
from neurotouch_hid.profile.mapping import Mapping

LEVELS: Final = 4
"""An axis is told in quarters: at rest, a quarter, half, three quarters, its end."""


@dataclass(frozen=True, slots=True)
class TimelineEntry:
    """One line of a timeline: a moment at which something changes.

    Attributes:
        t_us: the moment.
        gesture: what the hand begins to do, or empty.
        changes: what the outputs do, ``button a down``, and what was ignored and why.
    """

    t_us: int
    gesture: str
    changes: tuple[str, ...]

    def __str__(self) -> str:
        words = "; ".join((*([self.gesture] if self.gesture else []), *self.changes))
        return f"{self.t_us / 1e6:8.3f} s  {words}"


def perform(mapping: Mapping, gestures: Iterable[Gesture]) -> Iterator[TimelineEntry]:
    """Gives every moment at which something changes, is ignored, or takes a sequence further."""
    hand, before, layer = "", _flatten(GamepadState(0)), mapping.layer
    for gesture in gestures:
        state = mapping.update(gesture)
        now, doing = _flatten(state), _describe(gesture)
        changes = [_tell(name, now.get(name)) for name in _differ(before, now)]
        changes += [f"command {command}" for command in state.commands]
        if mapping.layer != layer:
            changes.append(f"layer {mapping.layer}")
        changes += [
            str(decision)
            for decision in mapping.decisions()
            if decision.t_us == gesture.t_us and (decision.is_refusal or decision.verdict == "step")
        ]
        if changes or doing != hand:
            yield TimelineEntry(gesture.t_us, doing if doing != hand else "", tuple(changes))
        hand, before, layer = doing, now, mapping.layer


def _describe(gesture: Gesture) -> str:
    if gesture.kind == GestureKind.NONE:
        return "rest"
    if gesture.kind != GestureKind.PUSH:
        return gesture.kind.label.replace("_", " ")
    x, y = gesture.translation_mm
    length = math.hypot(x, y)
    way = choose_direction((x / length, y / length), None, 8) if length > 0.0 else None
    return f"push {way.replace('_', ' ')}" if way is not None else "push"


def _flatten(state: GamepadState) -> dict[str, float]:
    """Returns everything that is not at rest: 1 for what is down, quarters for what moves."""
    flat = {f"button {button.value}": 1.0 for button in state.buttons}
    flat |= {f"key {key.removeprefix('KEY_').lower()}": 1.0 for key in state.keys}
    flat |= {f"mouse {button.removeprefix('BTN_').lower()}": 1.0 for button in state.mouse_buttons}
    moving = {axis.value: value for axis, value in state.axes.items()}
    flat |= {name: level for name, value in moving.items() if (level := _quantize(value))}
    speeds = zip(("pointer x", "pointer y"), state.pointer, strict=True)
    flat |= {name: level for name, speed in speeds if (level := 100.0 * round(speed / 100.0))}
    if state.wheel:
        flat["wheel"] = math.copysign(max(1.0, round(abs(state.wheel))), state.wheel)
    return flat


def _quantize(value: float) -> float:
    """Returns the nearest quarter; what moves by more than 1 % is not at rest."""
    if abs(value) < 0.01:
        return 0.0
    return math.copysign(max(1, round(LEVELS * abs(value))) / LEVELS, value)


def _differ(before: dict[str, float], now: dict[str, float]) -> list[str]:
    return sorted(name for name in before.keys() | now.keys() if before.get(name) != now.get(name))


def _tell(name: str, now: float | None) -> str:
    if name.startswith(("button", "key", "mouse")):
        return f"{name} {'up' if now is None else 'down'}"
    if name.startswith("pointer"):
        return f"{name} {now or 0.0:+.0f} px/s"
    if name == "wheel":
        return f"{name} {now or 0.0:+.0f} clicks/s"
    return f"{name} {100.0 * (now or 0.0):+.0f} %"
