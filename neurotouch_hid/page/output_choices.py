"""Lists the outputs that a movement can have, in the words of ``profile bind`` and the page."""

from typing import Final, TypedDict

from neurotouch_hid.profile.schema import KEYS, Profile
from neurotouch_hid.vocabulary import Button


class OutputChoice(TypedDict):
    """One output that a movement can have.

    Attributes:
        do: its form for ``parse_do``.
        label: its name on the page.
        follows: True if it follows the size of the movement; else it is on or off.
    """

    do: str
    label: str
    follows: bool


class OutputGroup(TypedDict):
    """Outputs of one device."""

    name: str
    outputs: list[OutputChoice]


_NAMES: Final = {
    "lb": "left bumper",
    "rb": "right bumper",
    "ls": "press the left stick",
    "rs": "press the right stick",
}
_WAYS: Final = ("up", "down", "left", "right")


def list_outputs(profile: Profile | None = None) -> list[OutputGroup]:
    """Returns everything to choose from, in the order of the page.

    Args:
        profile: its layers can be chosen.
    """
    axes = [
        ("axis left_x -", "left stick to the left"),
        ("axis left_x +", "left stick to the right"),
        ("axis left_y -", "left stick up"),
        ("axis left_y +", "left stick down"),
        ("axis right_x -", "right stick to the left"),
        ("axis right_x +", "right stick to the right"),
        ("axis right_y -", "right stick up"),
        ("axis right_y +", "right stick down"),
    ]
    layers = [] if profile is None else profile.all_layers[1:]
    groups = [
        ("Buttons", [_press(f"button {each}", _NAMES.get(each, _name(each))) for each in Button]),
        ("D-pad", [_press(f"dpad {way}", f"D-pad {way}") for way in _WAYS]),
        ("Triggers", [_follow(f"trigger {side}", f"{side} trigger") for side in ("left", "right")]),
        (
            "Sticks",
            [
                _follow("stick left", "left stick, all directions"),
                _follow("stick right", "right stick, all directions"),
                *(_follow(*axis) for axis in axes),
            ],
        ),
        (
            "Mouse",
            [
                *(_press(f"mouse {side}", f"{side} click") for side in ("left", "right", "middle")),
                _follow("mouse pointer", "move the pointer"),
                _follow("mouse wheel", "turn the wheel"),
            ],
        ),
        ("Keyboard", [_press(f"key {key}", key) for key in KEYS]),
        ("Layers", [_press(f"layer {layer.name}", f"layer {layer.name}") for layer in layers]),
        (
            "NeuroTouch itself",
            [
                _press("pause", "pause"),
                _press("panic", "stop everything"),
                _press("rezero", "use the present pose as neutral"),
                _press("next profile", "next favourite profile"),
            ],
        ),
    ]
    return [{"name": name, "outputs": outputs} for name, outputs in groups if outputs]


def _name(button: str) -> str:
    return button.upper() if len(button) == 1 else button


def _press(do: str, label: str) -> OutputChoice:
    return {"do": do, "label": label, "follows": False}


def _follow(do: str, label: str) -> OutputChoice:
    return {"do": do, "label": label, "follows": True}
