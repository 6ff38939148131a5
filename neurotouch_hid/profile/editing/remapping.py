"""Gives the bindings of one movement to others, for people who can hardly make it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

from neurotouch_hid.files.faults import Keys
from neurotouch_hid.profile.diagnostics.description import describe_binding, describe_condition
from neurotouch_hid.profile.editing.profile_text import ProfileText
from neurotouch_hid.profile.editing.text_layout import find_part
from neurotouch_hid.profile.editing.yaml_values import format_value
from neurotouch_hid.profile.schema.conditions import Condition
from neurotouch_hid.profile.schema.movements import MOVEMENTS
from neurotouch_hid.profile.schema.profile import FIRST_LAYER, Binding

WrittenWhen = dict[str, Any]
"""A condition as a profile writes it: ``{"gesture": "pinch", "press": "long"}``."""

_PRESSES: Final = ("long", "double", "hold", "tap")


@dataclass(frozen=True, slots=True)
class Remapping:
    """The result of a remapping.

    Attributes:
        text: the profile now.
        moved: what other movements do now, ``pinch long -> button b``.
        left: what nothing does any more, in the same words.
    """

    text: ProfileText
    moved: tuple[str, ...] = ()
    left: tuple[str, ...] = ()


def remap(text: ProfileText, weak: str, substitutes: Sequence[WrittenWhen]) -> Remapping:
    """Returns the profile with everything a movement does given to other conditions.

    What is pressed is pressed by a substitute instead. A trigger or an axis that followed the
    movement is pressed to its end, until the substitute comes again. A stick, the pointer or the
    wheel cannot be pressed: a substitute leads to a layer in which the opposite movement does what
    this one did, as finely as before, and back again.

    Args:
        text: the profile.
        weak: the movement.
        substitutes: what may replace it, the best first; each is used once in a layer.
    """
    moved: list[str] = []
    left: list[str] = []
    first: list[Any] = []
    for keys, name, layer in _list_layers(text.document):
        bindings = layer["bindings"]
        first = first or bindings
        taken = [*bindings, *(first if layer.get("below") != "empty" else ())]
        turned: dict[int, Any] = {}
        now = dict(enumerate(bindings))
        for i, binding in enumerate(bindings):
            if _is_turned(binding, weak):
                turned[i] = _turn(binding, weak)
            elif _is_made_by(binding["when"], weak):
                when = _choose(substitutes, taken)
                if when is None:
                    left.append(_describe(binding))
                    continue
                pressed = {"when": when, "do": _press(binding["do"])}
                taken.append(pressed)
                now[i] = pressed
                if pressed["do"] != binding["do"]:
                    text = text.replace((*keys, i, "do"), pressed["do"])
                text = text.replace((*keys, i, "when"), when)
                moved.append(_describe(pressed))
        if not turned:
            continue
        strong = MOVEMENTS[weak].partner
        for i, binding in enumerate(bindings):
            if _is_made_by(binding["when"], strong) and _is_turned(binding, strong):
                turned[i] = _turn(binding, strong)
        when = _choose(substitutes, taken, [binding["when"] for binding in turned.values()])
        if when is None:
            left += [_describe(bindings[i]) for i in turned]
            continue
        text = _add_turned_layer(text, keys, name, layer, [*(now | turned).values()], when)
        words = describe_condition(_read(when))
        moved += [f"{words} turns round {_describe(bindings[i])}" for i in turned]
    return Remapping(text, tuple(moved), tuple(left))


def remap_unused(text: ProfileText, unused: Sequence[str]) -> Remapping:
    """Returns the profile without the movements a person does not make, if others are free."""
    moved: list[str] = []
    left: list[str] = []
    for weak in unused:
        done = remap(text, weak, list_substitutes(weak, unused))
        text = done.text
        moved += done.moved
        left += done.left
    return Remapping(text, tuple(moved), tuple(left))


def list_substitutes(weak: str, unused: Sequence[str] = ()) -> list[WrittenWhen]:
    """Returns the substitutes of a movement: its partner in every press, then the others."""
    partner = MOVEMENTS[weak].partner
    others = [name for name in MOVEMENTS if name not in (weak, partner)]
    ways: list[tuple[str, str]] = [(partner, press) for press in _PRESSES]
    ways += [(name, press) for press in _PRESSES for name in others]
    return [make_when(name, press) for name, press in ways if name not in unused]


def make_when(movement: str, press: str) -> WrittenWhen:
    """Returns a movement's condition: ``push_left`` and ``tap`` is a short push to the left."""
    gesture, _, way = movement.partition("_")
    if gesture == "push":
        return {"gesture": "push", "direction": way, "press": press}
    return {"gesture": movement, "press": press}


def _list_layers(document: Any) -> Iterator[tuple[Keys, str, Any]]:
    """Gives the path of each layer's bindings, its name, and the layer."""
    if "bindings" in document:
        yield ("bindings",), FIRST_LAYER, {"bindings": document["bindings"]}
    for i, layer in enumerate(document.get("layers", [])):
        yield ("layers", i, "bindings"), layer["name"], layer


def _is_made_by(when: Any, movement: str) -> bool:
    """Tells whether only this movement meets a condition, or no other can."""
    if isinstance(when, str):
        return when == movement
    if "sequence" in when:
        return movement in when["sequence"]
    gesture, direction = when.get("gesture"), when.get("direction")
    return movement == (f"{gesture}_{direction}" if gesture == "push" else gesture)


def _is_turned(binding: Any, movement: str) -> bool:
    """Tells whether the movement is one side of a two-sided binding, or moves an axis."""
    model = Binding.model_validate(binding)
    do = binding["do"]
    if not model.is_followed or do.get("follow", "push").startswith("position"):
        return False
    planar = _is_planar(do)
    if _is_made_by(binding["when"], movement):
        return planar or do.get("mouse") == "wheel"
    condition = model.condition
    if condition.gesture == "push" and condition.direction is None:
        sideways = movement in ("push_left", "push_right")
        along = movement in ("push_up", "push_down")
        part = do.get("follow")
        return (sideways and (planar or part == "push_x")) or (
            along and (planar or part == "push_y")
        )
    return condition.gesture in ("twist", "scale") and movement in [
        k.label for k in condition.kinds
    ]


def _turn(binding: Any, weak: str) -> Any:
    """Returns the binding with the two ways exchanged."""
    when, do = binding["when"], dict(binding["do"])
    if _is_made_by(when, weak):
        gesture, _, way = MOVEMENTS[weak].partner.partition("_")
        if gesture == "push":
            when = {**when, "direction": way}
        else:
            strong = MOVEMENTS[weak].partner
            when = strong if isinstance(when, str) else {**when, "gesture": strong}
        if do.get("mouse") == "wheel":
            return {"when": when, "do": do}
    key = "invert"
    if _is_planar(do):
        key = "invert_x" if weak in ("push_left", "push_right") else "invert_y"
    if do.pop(key, False):
        return {"when": when, "do": do}
    return {"when": when, "do": {**do, key: True}}


def _press(do: Any) -> Any:
    """Returns the same to be pressed: what followed goes to its end, and the next time back."""
    if ("axis" in do or "trigger" in do) and "value" not in do:
        kept = {key: do[key] for key in ("axis", "trigger", "sign") if key in do}
        return {**kept, "value": 1.0, "mode": "toggle"}
    return do


def _choose(
    substitutes: Sequence[WrittenWhen], taken: Sequence[Any], turning: Sequence[Any] = ()
) -> WrittenWhen | None:
    """Returns the first substitute that nothing else reacts to; None if there is none.

    What steers is held all the time anyway, so only a quick press of it is a substitute.
    """
    steering = [*turning, *(b["when"] for b in taken if _is_planar(b["do"]))]
    steered = {kind for when in steering for kind in _read(when).kinds}
    for substitute in substitutes:
        if substitute["press"] in ("hold", "long") and not steered.isdisjoint(
            _read(substitute).kinds
        ):
            continue
        if not any(_is_heard(substitute, binding) for binding in taken):
            return substitute
    return None


def _is_planar(do: Any) -> bool:
    return "stick" in do or do.get("mouse") == "motion"


def _is_heard(substitute: WrittenWhen, binding: Any) -> bool:
    """Returns True if a binding would react to the substitute too."""
    model = Binding.model_validate(binding)
    if model.is_followed or "sequence" in binding["when"]:
        return False
    condition = model.condition
    asked = _read(substitute)
    return (
        condition.press in (None, asked.press)
        and condition.on_mm in (None, asked.on_mm)
        and bool(set(condition.kinds) & set(asked.kinds))
        and (
            None in (condition.direction, asked.direction) or condition.direction == asked.direction
        )
    )


def _add_turned_layer(
    text: ProfileText, keys: Keys, name: str, layer: Any, bindings: list[Any], when: WrittenWhen
) -> ProfileText:
    """Returns the text with a layer that reverses some bindings, and the way there and back."""
    new = f"{name[:57]}-turned"
    text = text.append(keys, {"when": when, "do": {"layer": new}})
    bindings = [*bindings, {"when": when, "do": {"layer": name}}]
    is_first = keys in (("bindings",), ("layers", 0, "bindings"))
    below = "empty" if is_first else layer.get("below", "inherit")
    return _append_layer(text, {"name": new, "below": below, "bindings": bindings})


def _append_layer(text: ProfileText, layer: dict[str, Any]) -> ProfileText:
    """Returns the text with a further layer at its end, written as people do: a binding a line."""
    if "layers" not in text.document:
        return text.insert_lines(len(text.text), ["", "layers:", *_write_layer(layer, "  ")])
    part = find_part(text.layout, ("layers",))
    if part.style == "flow":
        return text.append(("layers",), layer)
    return text.insert_lines(part.end, ["", *_write_layer(layer, " " * part.column)])


def _write_layer(layer: dict[str, Any], indent: str) -> list[str]:
    lines = [f"{indent}- name: {format_value(layer['name'])}"]
    lines += [f"{indent}  below: {layer['below']}", f"{indent}  bindings:"]
    for binding in layer["bindings"]:
        lines.append(f"{indent}    - when: {format_value(binding['when'])}")
        lines.append(f"{indent}      do: {format_value(binding['do'])}")
    return lines


def _read(when: Any) -> Condition:
    return Binding.model_validate({"when": when, "do": {"command": "rezero"}}).condition


def _describe(binding: Any) -> str:
    return describe_binding(Binding.model_validate(binding))
