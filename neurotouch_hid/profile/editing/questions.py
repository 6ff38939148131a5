"""Choices of the guided editor: gestures, outputs and the keys of a binding."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final, Literal, get_args, get_origin

from pydantic import BaseModel

from neurotouch_hid.profile.engine.response import make_response
from neurotouch_hid.profile.schema.conditions import Condition, Sequence
from neurotouch_hid.profile.schema.profile import Binding
from neurotouch_hid.profile.schema.shaping import Shaped
from neurotouch_hid.profile.schema.targets import TARGETS
from neurotouch_hid.vocabulary import Button, GestureKind

GESTURES: Final = (
    "push",
    "push left",
    "push right",
    "push up",
    "push down",
    "pinch",
    "zoom",
    "twist cw",
    "twist ccw",
)
PRESSES: Final = {
    "as soon and as long as the gesture is there": "",
    "tap: a short one": "tap",
    "double: two short ones": "double",
    "hold: a longer one": "hold",
    "long: a very long one": "long",
}
OUTPUTS: Final[dict[str, tuple[str, ...]]] = {
    "a button of the pad": tuple(f"button {button.value}" for button in Button),
    "a trigger": ("trigger left", "trigger right"),
    "a whole stick": ("stick left", "stick right"),
    "one axis of a stick": tuple(
        f"axis {side} {axis} {sign}" for side in ("left", "right") for axis in "xy" for sign in "+-"
    ),
    "the D-pad": ("dpad left", "dpad right", "dpad up", "dpad down"),
    "a key of the keyboard": (),
    "the mouse": (
        "mouse pointer",
        "mouse wheel",
        "mouse left",
        "mouse right",
        "mouse middle",
    ),
    "the program itself": ("pause", "panic", "rezero", "next profile"),
}
"""What a binding can do, in the words of ``parse_do``; of a key the person types the name."""

_STEPS: Final = 10
_IDENTITY: Final = {"when": ("gesture", "direction", "sequence"), "do": tuple(TARGETS)}


@dataclass(frozen=True, slots=True)
class Question:
    """A key of a binding that can be set.

    Attributes:
        key: its name.
        part: where it is, ``when`` or ``do``.
        description: what it is, its unit and default.
        value: what is written now, or None where the default applies.
        choices: the known words; empty if it is not a choice.
    """

    key: str
    part: Literal["when", "do"]
    description: str
    value: Any
    choices: tuple[str, ...]


def list_questions(binding: Binding) -> Iterator[Question]:
    """Gives every key of a binding that says how, not what."""
    parts: list[tuple[Literal["when", "do"], BaseModel | str]] = [
        ("do", binding.do),
        ("when", binding.when),
    ]
    for part, model in parts:
        written = {} if isinstance(model, str) else model.model_dump(exclude_unset=True)
        kind = Condition if isinstance(model, str) else type(model)
        for key, field in kind.model_fields.items():
            if key in _IDENTITY[part]:
                continue
            if binding.is_followed and key in _TIMED:
                continue
            words = list_words(field.annotation)
            yield Question(key, part, field.description or "", written.get(key), words)


_TIMED: Final = frozenset(
    ("press", "trigger", "accept_ms", "ignore_repeat_ms", "hold_ms", "mode", "repeat")
) | frozenset(("every_ms", "max_s"))
"""Keys of what is pressed; what follows a gesture has none of them."""


def list_words(annotation: Any) -> tuple[str, ...]:
    """Returns the words of a choice, or none if it is not one."""
    if annotation is bool:
        return ("true", "false")
    if get_origin(annotation) is Literal:
        return tuple(str(word) for word in get_args(annotation))
    inner = [list_words(option) for option in get_args(annotation)]
    found = [words for words in inner if words]
    return found[0] if len(found) == 1 and len(inner) <= 2 else ()


def sample_response(binding: Binding) -> list[tuple[str, float]]:
    """Returns the value of what follows a gesture at some measures from 0 to beyond its range.

    Returns:
        (measure with its unit, value of 0..1) from small to large; empty for what is pressed.
    """
    if not binding.is_followed or isinstance(binding.when, Sequence):
        return []
    assert isinstance(binding.do, Shaped)  # noqa: S101  is_followed says so; for the type checker
    kinds = [kind for kind in binding.condition.kinds if kind != GestureKind.NONE]
    range_ = binding.range_for(kinds[0])
    respond = make_response(range_, binding.do)
    step = range_[1] / (_STEPS - 1)
    unit = "mm/s" if getattr(binding.do, "follow", "") == "speed" else "mm"
    return [(f"{i * step:.1f} {unit}", respond(i * step)) for i in range(_STEPS + 1)]
