"""What pydantic found in a profile, put in plain words and in its place."""

import re
from collections.abc import Mapping, Sequence
from typing import Any, Final

from pydantic import BaseModel, ValidationError

from neurotouch_hid.profile.document import Node
from neurotouch_hid.profile.faults import Fault, Mark, format_path, make_printable, suggest
from neurotouch_hid.profile.schema import TARGETS, Binding, Condition, Expo, Power, Profile

Keys = tuple[str | int, ...]

_MODELS: Final[Mapping[str, type[BaseModel]]] = {
    "": Profile,
    "bindings": Binding,
    "<pattern>": Condition,
    "<expo>": Expo,
    "<power>": Power,
    **{f"<{key}>": model for key, model in TARGETS.items()},
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
    return [_locate_fault(detail, root) for detail in details]


def _locate_fault(detail: Mapping[str, Any], root: Node) -> Fault:
    context = detail.get("ctx", {})
    loc: Keys = (*detail["loc"], *context.get("at", ()))
    keys = tuple(key for key in loc[:-1] if key not in _TAGS) + loc[-1:]
    if keys and keys[-1] in _TAGS and detail["type"] != "extra_forbidden":
        keys = keys[:-1]
    node, found = _walk(root, keys)
    known = _known_keys(loc[:-1])
    match detail["type"]:
        case "extra_forbidden":
            word = str(keys[-1])
            listed = ", ".join(known)
            return Fault(
                _key_mark(root, keys),
                format_path(keys),
                f"unknown key; known here: {listed}",
                suggest(word, known),
            )
        case "missing" if isinstance(keys[-1], int):
            sentence, hint = "needs two numbers, [rest, full]", ""
            keys = keys[:-1]
        case "missing":
            sentence = f"the key '{keys[-1]}' is missing"
            hint = _suggest_slip(node, str(keys[-1]), known)
            keys = keys[:-1]
        case "one_of":
            sentence = detail["msg"]
            hint = _suggest_among(node, sentence.partition(": ")[2].split(", "))
        case _:
            sentence, hint = _word(detail, loc, node if found else None)
    return Fault(_value_mark(root, keys), format_path(keys), sentence, hint)


def _word(detail: Mapping[str, Any], loc: Keys, node: Node | None) -> tuple[str, str]:
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
            sentence = f"{value} is too small, at least {context['ge']:g}{_unit(loc)}"
        case "less_than_equal":
            sentence = f"{value} is too large, at most {context['le']:g}{_unit(loc)}"
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
    return f"{node.value:g}" if isinstance(node.value, float) else str(node.value)


def _unit(loc: Keys) -> str:
    names = [key for key in loc if isinstance(key, str) and key not in _TAGS]
    place = next((i for i in reversed(range(len(loc))) if loc[i] == names[-1]), 0) if names else 0
    model = _model(loc[:place])
    info = model.model_fields.get(names[-1]) if names else None
    extra = info.json_schema_extra if info is not None else None
    unit = extra.get("x-unit", "1") if isinstance(extra, dict) else "1"
    return "" if unit == "1" else f" {unit}"


def _model(parent: Keys) -> type[BaseModel]:
    names = [key for key in parent if isinstance(key, str)]
    return _MODELS.get(names[-1] if names else "", Profile)


def _known_keys(parent: Keys) -> tuple[str, ...]:
    return tuple(_model(parent).model_fields)


def _suggest_slip(node: Node, key: str, known: Sequence[str]) -> str:
    """Where a key is missing, one that is nearly it may be there."""
    slips = (stray for stray in node.keys if stray not in known and suggest(stray, [key]))
    return next((f"is '{make_printable(slip)}' meant to be '{key}'?" for slip in slips), "")


def _suggest_among(node: Node, forms: Sequence[str]) -> str:
    present = [key for key in node.keys if key in forms]
    if len(present) > 1:
        return f"here are {' and '.join(present)}"
    return next((hint for key in node.keys if (hint := suggest(key, forms))), "")


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
