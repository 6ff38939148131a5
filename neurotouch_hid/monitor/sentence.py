"""Describes a gesture and the state of a pad in words."""

import math

from neurotouch_hid.messages import Axis, GamepadState, Gesture, GestureKind

_KINDS = {
    GestureKind.NONE: "at rest",
    GestureKind.PUSH: "push",
    GestureKind.PINCH: "pinch",
    GestureKind.ZOOM: "zoom",
    GestureKind.TWIST_CW: "twist clockwise",
    GestureKind.TWIST_CCW: "twist counter-clockwise",
}
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


def describe_pad(pad: GamepadState) -> str:
    """Returns for example ``left_x -45 %, button a``; ``neutral`` if nothing is pressed."""
    shares = {axis: round(100 * pad.axes.get(axis, 0.0)) for axis in Axis}
    parts = [f"{axis} {share:+d} %" for axis, share in shares.items() if share]
    parts += [f"button {button}" for button in sorted(pad.buttons)]
    return ", ".join(parts) or "neutral"
