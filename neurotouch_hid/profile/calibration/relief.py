"""Relief for a weak movement: what it does goes to another one."""

from typing import Any

from neurotouch_hid.profile.editing.changes import replace_value
from neurotouch_hid.profile.editing.layout import read_layout
from neurotouch_hid.profile.faults import Keys


def hand_over(text: str, weak: str, when: dict[str, Any]) -> tuple[str, list[str]]:
    """The profile with everything a movement does given to another condition.

    What followed the movement (a trigger, an axis) is pressed to its end by the new one and stays
    so until it comes again.

    Args:
        text: the profile.
        weak: the movement whose bindings go.
        when: the new condition, ``{"gesture": "pinch", "press": "hold"}``.

    Returns:
        The new text, and what was given over, in the words of the profile; empty if the movement
        does nothing here, or only moves a whole stick or the pointer, which no other one can.
    """
    _, document = read_layout(text, "the profile")
    moved = []
    for keys, binding in _list_bindings(document):
        if not _is_movement(binding["when"], weak) or "stick" in binding["do"]:
            continue
        do = dict(binding["do"])
        if do.get("mouse") in ("motion", "wheel"):
            continue
        if ("axis" in do or "trigger" in do) and "value" not in do:
            kept = ("axis", "trigger", "sign")
            do = {key: value for key, value in do.items() if key in kept}
            do |= {"value": 1.0, "mode": "toggle"}
            text = replace_value(text, (*keys, "do"), do)
        text = replace_value(text, (*keys, "when"), when)
        moved.append(" ".join(str(value) for value in do.values()))
    return text, moved


def _list_bindings(document: Any) -> list[tuple[Keys, Any]]:
    lists: list[tuple[Keys, Any]] = [(("bindings",), document.get("bindings", []))]
    for i, layer in enumerate(document.get("layers", [])):
        lists.append((("layers", i, "bindings"), layer.get("bindings", [])))
    return [((*keys, i), binding) for keys, items in lists for i, binding in enumerate(items)]


def _is_movement(when: Any, movement: str) -> bool:
    """True of a condition that only this movement meets."""
    if isinstance(when, str):
        return when == movement
    gesture, direction = when.get("gesture"), when.get("direction")
    return movement == (f"{gesture}_{direction}" if gesture == "push" else gesture)
