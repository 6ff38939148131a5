"""Puts the errors that pydantic finds into plain words, each at its place."""

import re
from collections.abc import Mapping, Sequence
from typing import Any, Final

from pydantic import BaseModel, ValidationError

from neurotouch_hid.files.faults import Fault, Keys, Mark, format_path, suggest
from neurotouch_hid.files.yaml_document import Node, find_key_mark, find_mark, find_node
from neurotouch_hid.printable import make_printable
from neurotouch_hid.profile.schema.targets import MICE
from neurotouch_hid.profile.schema.tree import find_model
from neurotouch_hid.vocabulary import NAME_PATTERN

_NEEDS: Final = {
    "float_type": "needs a number",
    "int_type": "needs a whole number",
    "string_type": "needs a word",
    "bool_type": "needs true or false",
    "tuple_type": "needs a list of two numbers, {pair}",
    "list_type": "needs a list",
    "model_type": "needs keys with values",
    "model_attributes_type": "needs keys with values",
}

_CODES: Final = {
    "extra_forbidden": "NT110",
    "missing": "NT111",
    "literal_error": "NT112",
    "enum": "NT112",
    "greater_than_equal": "NT114",
    "less_than_equal": "NT114",
    "finite_number": "NT115",
    "string_too_long": "NT116",
    "too_short": "NT116",
    "too_long": "NT116",
    "one_of": "NT117",
    "string_pattern_mismatch": "NT118",
    "version": "NT119",
    "invisible": "NT120",
    "direction": "NT121",
    "thresholds": "NT122",
    "range": "NT123",
    "stick": "NT124",
    "timed": "NT125",
    "mode": "NT125",
    "key": "NT127",
    "key_twice": "NT127",
    "chord": "NT127",
    "points": "NT114",
    **dict.fromkeys(_NEEDS, "NT113"),
}
"""By pydantic's name of an error, or ours; all others are keys that do not go together."""


_UNITS: Final = {
    "_mm": "mm",
    "_mm_s": "mm/s",
    "_ms": "ms",
    "_deg": "deg",
    "full": "mm",
    "rest": "mm",
}


def locate_faults(error: ValidationError, root: Node, model: type[BaseModel]) -> list[Fault]:
    """Gives every error of the validation of ``model`` as a fault at its place in the document."""
    details = error.errors(include_url=False, include_input=False)
    found = (_locate_fault(detail, root, model) for detail in details)
    faults = [fault for fault in found if fault is not None]
    if any(fault.code == _CODES["version"] for fault in faults):
        # A file of another version may have other keys, so ours say nothing about it.
        faults = [fault for fault in faults if fault.code == _CODES["version"]]
    return faults


def _locate_fault(detail: Mapping[str, Any], root: Node, model: type[BaseModel]) -> Fault | None:
    """Returns the fault, or None for a missing key that is there with a slip in it."""
    kind, context = detail["type"], detail.get("ctx", {})
    loc: Keys = (*detail["loc"], *context.get("at", ()))
    keys = tuple(key for key in loc[:-1] if not _is_tag(key)) + loc[-1:]
    parent_model = find_model(model, loc[:-1])
    known = tuple(parent_model.model_fields) if parent_model is not None else ()
    code = _CODES.get(kind, "NT126")
    if kind == "extra_forbidden":
        sentence = f"unknown key; known here: {', '.join(known)}"
        hint = suggest(str(keys[-1]), known)
        return Fault(find_key_mark(root, keys), format_path(keys), sentence, hint, code)
    keys = tuple(key for key in keys if not _is_tag(key))
    mark = find_mark(root, keys)
    if kind == "missing" and isinstance(keys[-1], str):
        parent, _ = find_node(root, keys[:-1])
        if any(suggest(key, known) == suggest(keys[-1], known) for key in parent.keys):
            return None  # the unknown key is reported, with this one as its suggestion
        return Fault(mark, format_path(keys[:-1]), f"the key '{keys[-1]}' is missing", code=code)
    if kind == "missing":
        keys = keys[:-1]
        sentence, hint = f"needs two numbers, {_pair(keys)}", ""
    elif kind == "one_of":
        node, _ = find_node(root, keys)
        mark, hint = _point_at_choice(node, mark, detail["msg"].partition(": ")[2].split(", "))
        sentence = detail["msg"]
    else:
        node, found = find_node(root, keys)
        sentence, hint = _word(detail, keys, node if found else None)
    return Fault(mark, format_path(keys), sentence, hint, code)


def _is_tag(key: str | int) -> bool:
    """Returns True for what pydantic puts in a place to tell the forms of a value apart."""
    return isinstance(key, str) and key.startswith("<")


def _point_at_choice(node: Node, mark: Mark, forms: Sequence[str]) -> tuple[Mark, str]:
    """Returns the key at fault where exactly one is allowed: the surplus or the misspelt one."""
    if isinstance(node.value, str):
        return mark, suggest(node.value, forms)
    present = [key for key in node.keys if key in forms]
    if len(present) > 1:
        return node.keys[present[1]], f"beside '{present[0]}'"
    slips = ((place, suggest(key, forms)) for key, place in node.keys.items())
    return next((slip for slip in slips if slip[1]), (mark, ""))


def _word(detail: Mapping[str, Any], keys: Keys, node: Node | None) -> tuple[str, str]:
    """Returns the sentence and the hint for an error in a value."""
    kind, context, value = detail["type"], detail.get("ctx", {}), _show(node)
    hint = ""
    match kind:
        case "literal_error" | "enum":
            allowed = re.findall(r"[\w+-]+", context["expected"].replace(" or ", " "))
            if keys[-1] == "mouse":  # its other two words have models of their own
                allowed += MICE
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
            sentence = "needs 1 to 64 small letters, digits, _ or -, and no - in front"
            if context["pattern"] != NAME_PATTERN:
                sentence = f"{value} is empty, too long, or has a sign that is not possible here"
        case "string_too_long":
            sentence = f"is longer than {context['max_length']} characters"
        case "too_short":
            least = context["min_length"]
            sentence = "needs at least " + ("one entry" if least == 1 else f"{least} entries")
        case "too_long":
            sentence = f"has more than {context['max_length']} entries"
        case _ if kind in _NEEDS:
            sentence = f"{_NEEDS[kind].format(pair=_pair(keys))}, not {value}"
            if (
                node is not None
                and kind == "string_type"
                and not isinstance(node.value, dict | list)
            ):
                hint = f'write "{make_printable(str(node.value))[:40]}"'
            elif node is not None and kind in ("float_type", "int_type"):
                hint = _propose_number(str(node.value), _unit(keys).strip(), kind == "int_type")
            elif node is not None and kind == "list_type" and isinstance(node.value, str):
                hint = f"write [{make_printable(node.value)[:40]}]"
        case _:
            sentence = make_printable(detail["msg"])
            hint = context.get("hint", "")
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


def _propose_number(written: str, unit: str, is_whole: bool) -> str:
    """Returns the number that is meant by ``4,5`` or ``4 mm``, as a hint; or nothing."""
    found = re.fullmatch(r"([+-]?\d+)(?:[.,](\d+))?\s*([a-z/]*)", written.strip())
    if found is None or found[3] not in ("", unit):
        return ""
    part = (found[2] or "").rstrip("0") if is_whole else found[2]
    if is_whole and part:
        return ""
    return f"write {found[1]}" + (f".{part}" if part else "")


def _unit(keys: Keys) -> str:
    names = [key for key in keys if isinstance(key, str)] or [""]
    unit = next((unit for suffix, unit in _UNITS.items() if names[-1].endswith(suffix)), "")
    return f" {unit}" if unit else ""


def _pair(keys: Keys) -> str:
    """Names the two numbers of a list."""
    names = [key for key in keys if isinstance(key, str)]
    return "[rest, full]" if names and names[-1].startswith("range") else "[x, y]"
