"""Paths to a value as people write them: ``push.curve.expo``, ``layers.fly.pinch.on_mm``.

A part is a key, a number in a list (``bindings[0]`` or ``bindings.0``), the name of a layer, or the
gesture of a binding in one word (``push_left_tap``; with ``#2`` the second of that kind). A binding
may be named without its list, and what is under its ``when`` and ``do`` without those.
"""

import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Final

from pydantic import BaseModel

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.faults import Keys, find_near, format_path
from neurotouch_hid.printable import make_printable
from neurotouch_hid.profile.schema.conditions import CONDITION_KEYS, Condition
from neurotouch_hid.profile.schema.profile import Binding, Profile
from neurotouch_hid.profile.schema.timing import Timing
from neurotouch_hid.profile.schema.tree import find_model

_PART: Final = re.compile(r"\[(\d+)\]|([^.\[\]]+)")
_MOST_PATHS: Final = 3
_UNNAMED: Final = ("contacts", "with_button", "on_mm")
_PATH: Final = re.compile(r"[^.\[\]]+(\.[^.\[\]]+|\[\d+\])*")


@dataclass(frozen=True, slots=True)
class KeyPath:
    """The path to a value.

    Attributes:
        keys: every key on it.
        exists: whether the value is there.
        widen: keys whose value is a word and must become keys of its own, and the key of that word:
            ``when: push`` becomes ``when: {gesture: push}``.
    """

    keys: Keys
    exists: bool
    widen: tuple[Keys, str] | None = None


def find_key_path(document: Any, path: str, model: type[BaseModel] = Profile) -> KeyPath:
    """Returns the path a person means.

    Args:
        document: the plain value of the document.
        path: what the person wrote.
        model: what the document is.

    Raises:
        ProfileError: there is no such key, or a part could mean several things.
    """
    if not _PATH.fullmatch(path):
        raise _refuse(path, "")
    parts = [number or word for number, word in _PART.findall(path)]
    return _follow(document, (), parts, path, model)


def _follow(value: Any, keys: Keys, parts: list[str], path: str, model: type[BaseModel]) -> KeyPath:
    """Returns the path that some parts mean, from a place on; ``path`` is what the person wrote."""
    for i, part in enumerate(parts):
        hop = _hop(value, part, keys)
        if hop is None:
            return _find_new(value, keys, parts[i:], path, model)
        for key in hop:
            value = value[key]
        keys = (*keys, *hop)
    return KeyPath(keys, True)


def list_key_paths(document: Any, model: type[BaseModel] = Profile) -> Iterator[str]:
    """Returns every path that people may write, the shortest form of each, in the text's order."""
    for key, value in document.items() if isinstance(document, dict) else ():
        if key == "bindings":
            yield from _list_bindings(value, "")
        elif key == "layers":
            for layer in value:
                yield from _list_bindings(layer.get("bindings", []), f"layers.{layer.get('name')}.")
        else:
            yield from _list_leaves((key,), value, model)
    for key in model.model_fields:
        if key not in document and key not in ("bindings", "layers"):
            yield from _list_leaves((key,), None, model)


def name_binding(binding: Any) -> str:
    """Names the gesture of a binding: ``push_left_tap``, ``pinch``, ``push_up-zoom``."""
    when = binding.get("when") if isinstance(binding, dict) else None
    if isinstance(when, dict) and isinstance(when.get("sequence"), list):
        return "-".join(map(str, when["sequence"]))
    if not isinstance(when, dict):
        return str(when)
    keys = (key for key in CONDITION_KEYS if key not in _UNNAMED)
    return "_".join(str(when[key]) for key in keys if key in when)


def name_bindings(bindings: Any) -> list[str]:
    """Returns the names of all bindings of a list; from the second of a name on with its number."""
    names: list[str] = []
    seen: dict[str, int] = {}
    for name in map(name_binding, bindings):
        seen[name] = seen.get(name, 0) + 1
        names.append(name if seen[name] == 1 else f"{name}#{seen[name]}")
    return names


def _hop(value: Any, part: str, keys: Keys) -> Keys | None:
    """Returns the keys that a part means, or None if there are none."""
    if isinstance(value, list):
        names = _name_items(value, keys)
        if part.isdecimal() and int(part) < len(value):
            return (int(part),)
        return (names.index(part),) if part in names else None
    if not isinstance(value, dict) or part in value:
        return (part,) if isinstance(value, dict) else None
    if "bindings" in value and part in (names := name_bindings(value["bindings"])):
        return ("bindings", names.index(part))
    inner = (key for key in ("do", "when") if isinstance(value.get(key), dict))
    return next(((key, part) for key in inner if part in value[key]), None)


def _name_items(items: Any, keys: Keys) -> list[str]:
    """Names the items of a list at a place: layers by name, bindings by gesture."""
    if keys[-1:] == ("layers",):
        return [str(item.get("name")) for item in items]
    return name_bindings(items) if keys[-1:] == ("bindings",) else []


def _find_new(
    value: Any, keys: Keys, rest: list[str], path: str, model: type[BaseModel]
) -> KeyPath:
    """Returns the path to a key that is not there yet."""
    part = rest[0]
    if isinstance(value, dict) and len(rest) == 1:
        if "when" in value and "do" in value:
            do = _find_target(value["do"])
            if part in Condition.model_fields and (do is None or part not in do.model_fields):
                when = value["when"]
                if part == "gesture" and isinstance(when, str):
                    return KeyPath((*keys, "when"), True)
                widen = None if isinstance(when, dict) else ((*keys, "when"), "gesture")
                return KeyPath((*keys, "when", part), False, widen)
            if do is not None and part in do.model_fields:
                return KeyPath((*keys, "do", part), False)
        if part in list_known(value, keys, model):
            return KeyPath((*keys, part), False)
    if keys[-1:] == ("timing",) and part in Timing.model_fields and len(rest) == 1:
        return (
            KeyPath(keys, True)
            if part == "preset"
            else KeyPath((*keys, part), False, (keys, "preset"))
        )
    if isinstance(value, dict) and len(rest) > 1:
        do = _find_target(value["do"]) if "when" in value and "do" in value else None
        inner = (*keys, "do", part) if do is not None and part in do.model_fields else (*keys, part)
        if find_model(model, inner, {}) is not None:
            return _find_new({}, inner, rest[1:], path, model)
    before = path.removesuffix(".".join(rest))
    advice = _find_deeper(value, rest, keys, model) or _advise(value, rest, keys, model, before)
    raise _refuse(path, advice)


def list_known(value: Any, keys: Keys, model: type[BaseModel]) -> list[str]:
    """Returns the keys that may be in a mapping at a place."""
    found = find_model(model, keys, value) if isinstance(value, dict) else None
    return list(found.model_fields) if found is not None else []


def _find_target(do: Any) -> type[BaseModel] | None:
    return find_model(Binding, ("do",), do) if isinstance(do, dict) else None


def _find_deeper(value: Any, rest: list[str], keys: Keys, model: type[BaseModel]) -> str:
    """Returns a hint with the paths that end as the person has written, if there are some."""
    if keys:
        return ""
    end = "." + ".".join(rest)
    found = [f"'{path}'" for path in list_key_paths(value, model) if path.endswith(end)]
    return f"Did you mean {' or '.join(found[:_MOST_PATHS])}?" if found else ""


def _advise(value: Any, rest: list[str], keys: Keys, model: type[BaseModel], before: str) -> str:
    """Returns a hint with the path that was meant, or with the keys at its place.

    Args:
        value: what is at the place.
        rest: the wrong part of the path, and those after it.
        keys: the place.
        model: of the whole file.
        before: the path up to the wrong part, as the person has written it.
    """
    known: list[str] = []
    if isinstance(value, dict):
        known = [*value, *list_known(value, keys, model)]
        if "bindings" in value:
            known += name_bindings(value["bindings"])
        if "do" in value:
            do, when = _find_target(value["do"]), Condition
            known += [*when.model_fields, *(do.model_fields if do is not None else ())]
    elif isinstance(value, list):
        known = _name_items(value, keys)
    known = list(dict.fromkeys(known))
    part, *after = rest
    if part in known and after:
        return f"There is no '{make_printable(after[0])}' in '{make_printable(before + part)}' yet."
    near = find_near(part, known)
    if near is not None:
        meant = before + ".".join([near, *after])
        with suppress(ProfileError):
            _follow(value, keys, [near, *after], meant, model)
            return f"Did you mean '{make_printable(meant)}'?"
    where = f"Known in {format_path(keys)}" if keys else "Known here"
    return f"{where}: {', '.join(known)}." if known else ""


def _refuse(path: str, hint: str) -> ProfileError:
    shown = make_printable(path[:100])
    example = "For example: push.curve.expo, layers.menu.pinch.on_mm, timing."
    return ProfileError(f"No such key: '{shown}'.", hint=hint or example)


def _list_bindings(bindings: Any, prefix: str) -> Iterator[str]:
    for name, binding in zip(name_bindings(bindings), bindings, strict=True):
        do, when = binding.get("do", {}), binding.get("when")
        target = _find_target(do)
        keys = [*(when if isinstance(when, dict) else ()), *Condition.model_fields]
        keys += [*do, *(target.model_fields if target is not None else ())]
        for key in dict.fromkeys(keys):
            yield f"{prefix}{name}.{key}"
            inner = find_model(target, (key,), do.get(key)) if target is not None else None
            if inner is not None:
                yield from (f"{prefix}{name}.{key}.{part}" for part in inner.model_fields)


def _list_leaves(keys: Keys, value: Any, model: type[BaseModel]) -> Iterator[str]:
    found = find_model(model, keys, value)
    inner = value if isinstance(value, dict) else {}
    if found is None or not isinstance(value, dict):
        yield format_path(keys)
    for name in dict.fromkeys([*inner, *(found.model_fields if found is not None else ())]):
        yield from _list_leaves((*keys, name), inner.get(name), model)
