"""Describes a step in one sentence: the gesture, and the resulting outputs."""

from typing import Final

from neurotouch_hid.messages import Axis, GamepadState, Step
from neurotouch_hid.monitor import describe_gesture

_STICKS: Final = (
    ("left stick", Axis.LEFT_X, Axis.LEFT_Y),
    ("right stick", Axis.RIGHT_X, Axis.RIGHT_Y),
)
_TRIGGERS: Final = (
    ("left trigger", Axis.LEFT_TRIGGER),
    ("right trigger", Axis.RIGHT_TRIGGER),
)


def describe_step(step: Step, state: str) -> str:
    """Returns for example ``Zoom 3.2 mm, 2 fingers → right trigger 61 %``.

    Args:
        step: one step of the pipeline.
        state: of the mapping: running, paused or panic.
    """
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
