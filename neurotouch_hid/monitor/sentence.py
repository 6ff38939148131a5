"""Sentences for people: what the hand does, and what the pad makes of it."""

import math
from typing import Final

from neurotouch_hid.messages import Axis, GamepadState, Gesture, GestureKind, Step

_KINDS = {
    GestureKind.NONE: "at rest",
    GestureKind.PUSH: "push",
    GestureKind.PINCH: "pinch",
    GestureKind.ZOOM: "zoom",
    GestureKind.TWIST_CW: "twist clockwise",
    GestureKind.TWIST_CCW: "twist counter-clockwise",
}
_STICKS: Final = (
    ("left stick", Axis.LEFT_X, Axis.LEFT_Y),
    ("right stick", Axis.RIGHT_X, Axis.RIGHT_Y),
)
_TRIGGERS: Final = (
    ("left trigger", Axis.LEFT_TRIGGER),
    ("right trigger", Axis.RIGHT_TRIGGER),
)
_DIRECTIONS = ("right", "down-right", "down", "down-left", "left", "up-left", "up", "up-right")


def direction_deg(gesture: Gesture) -> float | None:
    """Returns the direction of a gesture: 0 right, 90 towards the user (down); None at rest."""
    if gesture.kind is GestureKind.NONE:
        return None
    x, y = gesture.translation_mm
    return math.degrees(math.atan2(y, x)) % 360


def describe_gesture(gesture: Gesture) -> str:
    """Returns for example ``push left 3.2 mm, 1 finger``."""
    if gesture.kind is GestureKind.NONE:
        return _KINDS[GestureKind.NONE]
    words = _KINDS[gesture.kind]
    angle = direction_deg(gesture)
    if gesture.kind is GestureKind.PUSH and angle is not None:
        words += " " + _DIRECTIONS[round(angle / 45) % 8]
    n = len(gesture.contacts_mm)
    return f"{words} {gesture.intensity_mm:.1f} mm, {n} finger{'' if n == 1 else 's'}"


def describe_step(step: Step, state: str) -> str:
    """Returns for example ``Zoom 3.2 mm, 2 fingers → right trigger 61 %``.

    Args:
        step: one step of the pipeline.
        state: of the mapping: running, paused or panic.
    """
    if not step.gel.is_found:
        return "No gel is found"
    said = describe_gesture(step.gesture)
    outcome = describe_outputs(step.pad)
    if state != "running":
        outcome = "paused, nothing acts" if state == "paused" else "stopped, nothing acts"
    elif not outcome and step.gesture.kind:
        outcome = "nothing"
    return said[:1].upper() + said[1:] + (f" → {outcome}" if outcome else "")


def describe_outputs(pad: GamepadState) -> str:
    """Returns for example ``left stick right 45 % up 20 %, button A``; empty at neutral."""
    parts = []
    for name, x_axis, y_axis in _STICKS:
        ways = [
            _share(pad.axes.get(x_axis, 0.0), "left", "right"),
            _share(pad.axes.get(y_axis, 0.0), "up", "down"),
        ]
        if any(ways):
            parts.append(" ".join([name, *filter(None, ways)]))
    for name, axis in _TRIGGERS:
        if share := round(100 * pad.axes.get(axis, 0.0)):
            parts.append(f"{name} {share} %")
    hat = [
        _way(pad.axes.get(Axis.DPAD_Y, 0.0), "up", "down"),
        _way(pad.axes.get(Axis.DPAD_X, 0.0), "left", "right"),
    ]
    if any(hat):
        parts.append(" ".join(["D-pad", *filter(None, hat)]))
    parts += [f"button {button.upper()}" for button in sorted(pad.buttons)]
    parts += [f"key {key.removeprefix('KEY_').lower()}" for key in sorted(pad.keys)]
    parts += [f"mouse {name.removeprefix('BTN_').lower()}" for name in sorted(pad.mouse_buttons)]
    if any(pad.pointer):
        parts.append("mouse moves")
    if pad.wheel:
        parts.append("wheel turns")
    return ", ".join(parts)


def _share(value: float, negative: str, positive: str) -> str:
    share = round(100 * abs(value))
    return f"{_way(value, negative, positive)} {share} %" if share else ""


def _way(value: float, negative: str, positive: str) -> str:
    return "" if not value else negative if value < 0 else positive
