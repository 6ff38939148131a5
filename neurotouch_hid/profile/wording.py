"""What pydantic found in a profile, put in plain words and in its place."""

import re
from collections.abc import Mapping, Sequence
from typing import Any, Final

from pydantic import BaseModel, ValidationError

from neurotouch_hid.profile.document import Node
from neurotouch_hid.profile.faults import Fault, Mark, format_path, make_printable, suggest
from neurotouch_hid.profile.schema import Binding, Condition, Profile
from neurotouch_hid.profile.targets import CURVES, TARGETS

Keys = tuple[str | int, ...]

_MODELS: Final[Mapping[str, type[BaseModel]]] = {
    "": Profile,
    "bindings": Binding,
    "<pattern>": Condition,
    **{f"<{key}>": model for key, model in (TARGETS | CURVES).items()},
}
"""The model whose keys stand at a place, by the last name (or union tag) on the way to it."""

_TAGS: Final = frozenset(key for key in _MODELS if key.startswith("<")) | {"<word>", "<name>"}

_NEEDS: Final = {
    "float_type": "needs a number",
    "int_type": "needs a whole number",
    "string_type": "needs a word",
    "bool_type": "needs true or false",
    "tuple_type": "needs a list of two numbers, [rest, full]",
    "list_type": "needs a list",
    "model_type": "needs keys with values",
    "model_attributes_type": "needs keys with values",
}


def locate_faults(error: ValidationError, root: Node) -> list[Fault]:
    """Every error of the validation as a fault at its place in the document."""
    details = error.errors(include_url=False, include_input=False)
    faults = (_locate_fault(detail, root) for detail in details)
    return [fault for fault in faults if fault is not None]


def _locate_fault(detail: Mapping[str, Any], root: Node) -> Fault | None:
    """The fault, or None for a missing key that stands there with a slip in it."""
    kind, context = detail["type"], detail.get("ctx", {})
    loc: Keys = (*detail["loc"], *context.get("at", ()))
    keys = tuple(key for key in loc[:-1] if key not in _TAGS) + loc[-1:]
    known = tuple(_model(loc[:-1]).model_fields)
    if kind == "extra_forbidden":
        sentence = f"unknown key; known here: {', '.join(known)}"
        hint = suggest(str(keys[-1]), known)
        return Fault(_key_mark(root, keys), format_path(keys), sentence, hint)
    keys = tuple(key for key in keys if key not in _TAGS)
    mark = _value_mark(root, keys)
    if kind == "missing" and isinstance(keys[-1], str):
        parent, _ = _walk(root, keys[:-1])
        if any(suggest(key, known) == suggest(keys[-1], known) for key in parent.keys):
            return None  # the unknown key is reported, with this one as its suggestion
        return Fault(mark, format_path(keys[:-1]), f"the key '{keys[-1]}' is missing")
    if kind == "missing":
        keys, sentence, hint = keys[:-1], "needs two numbers, [rest, full]", ""
    elif kind == "one_of":
        node, _ = _walk(root, keys)
        mark, hint = _point_at_choice(node, mark, detail["msg"].partition(": ")[2].split(", "))
        sentence = detail["msg"]
    else:
        node, found = _walk(root, keys)
        sentence, hint = _word(detail, keys, node if found else None)
    return Fault(mark, format_path(keys), sentence, hint)


def _point_at_choice(node: Node, mark: Mark, forms: Sequence[str]) -> tuple[Mark, str]:
    """Where exactly one of some keys must stand: the one too many, or the one with a slip."""
    if isinstance(node.value, str):
        return mark, suggest(node.value, forms)
    present = [key for key in node.keys if key in forms]
    if len(present) > 1:
        return node.keys[present[1]], f"beside '{present[0]}'"
    slips = ((place, suggest(key, forms)) for key, place in node.keys.items())
    return next((slip for slip in slips if slip[1]), (mark, ""))


def _word(detail: Mapping[str, Any], keys: Keys, node: Node | None) -> tuple[str, str]:
    """The sentence and the hint for an error in a value."""
    kind, context, value = detail["type"], detail.get("ctx", {}), _show(node)
    hint = ""
    match kind:
        case "literal_error" | "enum":
            allowed = re.findall(r"'([^']*)'", context["expected"])
            sentence = f"{value} is not one of: {', '.join(allowed)}"
            if node is not None and isinstance(node.value, str):
                hint = suggest(node.value, allowed)
        case "greater_than_equal":
            sentence = f"{value} is too small, at least {context['ge']:g}{_unit(keys)}"
        case "less_than_equal":
            sentence = f"{value} is too large, at most {context['le']:g}{_unit(keys)}"
        case "finite_number":
            sentence = f"needs a finite number, not {value}"
        case "string_pattern_mismatch":
            sentence = "needs 1 to 64 small letters, digits, _ or -"
        case "string_too_long":
            sentence = f"is longer than {context['max_length']} characters"
        case "too_short":
            sentence = "needs at least one entry"
        case "too_long":
            sentence = f"has more than {context['max_length']} entries"
        case _ if kind in _NEEDS:
            sentence = f"{_NEEDS[kind]}, not {value}"
        case _:
            sentence = detail["msg"]
    return sentence, hint


def _show(node: Node | None) -> str:
    if node is None:
        return "nothing"
    if isinstance(node.value, dict):
        return "keys with values"
    if isinstance(node.value, list):
        return "a list"
    if isinstance(node.value, bool):
        return str(node.value).lower()
    if isinstance(node.value, str):
        text = make_printable(node.value)
        return f"'{text[:40]}…'" if len(text) > 40 else f"'{text}'"
    return str(node.value)


def _unit(keys: Keys) -> str:
    names = [key for key in keys if isinstance(key, str)]
    return " mm" if names and names[-1].endswith("_mm") else ""


def _model(parent: Keys) -> type[BaseModel]:
    names = [key for key in parent if isinstance(key, str)]
    return _MODELS.get(names[-1] if names else "", Profile)


def _walk(root: Node, keys: Keys) -> tuple[Node, bool]:
    """The node the keys lead to, or the last one on the way, and whether it was reached."""
    node = root
    for key in keys:
        if key not in node.children:
            return node, False
        node = node.children[key]
    return node, True


def _value_mark(root: Node, keys: Keys) -> Mark:
    """The value's place; of a mapping or list in block style, its key's."""
    node, found = _walk(root, keys)
    if found and not isinstance(node.value, dict | list):
        return node.mark
    return _key_mark(root, keys)


def _key_mark(root: Node, keys: Keys) -> Mark:
    while keys:
        parent, _ = _walk(root, keys[:-1])
        if isinstance(keys[-1], str) and keys[-1] in parent.keys:
            return parent.keys[keys[-1]]
        node, found = _walk(root, keys)
        if found:
            return node.mark
        keys = keys[:-1]
    return root.mark
