"""A new layer in a profile, written as people write one: a binding a line."""

from typing import Any

from neurotouch_hid.profile.editing.changes import append_item, insert_lines
from neurotouch_hid.profile.editing.layout import find_part, read_layout
from neurotouch_hid.profile.editing.values import format_value


def append_layer(text: str, layer: dict[str, Any]) -> str:
    """Returns the text with a further layer at its end.

    Args:
        text: the profile.
        layer: the layer as a plain value, ``name``, perhaps ``below``, ``bindings``.
    """
    root, document = read_layout(text, "the profile")
    if "layers" not in document:
        lines = ["", "layers:", *_write(layer, "  ")]
        return insert_lines(text, len(text), lines)
    part = find_part(root, ("layers",))
    if part.style == "flow":
        return append_item(text, ("layers",), layer)
    return insert_lines(text, part.end, ["", *_write(layer, " " * part.column)])


def _write(layer: dict[str, Any], indent: str) -> list[str]:
    names = [f"{key}: {format_value(layer[key])}" for key in ("name", "below") if key in layer]
    lines = [f"{indent}- {names[0]}", *(f"{indent}  {name}" for name in names[1:])]
    lines.append(f"{indent}  bindings:")
    for binding in layer["bindings"]:
        lines.append(f"{indent}    - when: {format_value(binding['when'])}")
        lines.append(f"{indent}      do: {format_value(binding['do'])}")
    return lines
