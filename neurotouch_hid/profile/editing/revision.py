"""The edits people ask for: set a value, go back to a default, bind, unbind, rename, upgrade."""

from collections.abc import Collection
from typing import Any, Final

from pydantic import BaseModel

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.profile.editing.changes import (
    append_item,
    insert_key,
    remove_value,
    replace_value,
)
from neurotouch_hid.profile.editing.layout import read_layout
from neurotouch_hid.profile.editing.paths import find_way, list_known, name_bindings
from neurotouch_hid.profile.editing.values import parse_value
from neurotouch_hid.profile.faults import Keys, suggest
from neurotouch_hid.profile.schema.profile import Profile
from neurotouch_hid.profile.schema.tree import takes_list

VERSION: Final = 1
SPOKEN: Final = (
    "sequence",
    "gesture",
    "direction",
    "zone",
    "contacts",
    "with_button",
    "level",
    "press",
    "phase",
    "on_mm",
)
"""The keys of ``when`` that tell bindings apart for people."""

MODELINE: Final = "# yaml-language-server: $schema="


def set_value(text: str, path: str, value: Any, model: type[BaseModel] = Profile) -> str:
    """Returns the text with a value at the place a person names.

    What is missing on the way is added. Where a list belongs, words may come without brackets.

    Raises:
        ProfileError: the path leads nowhere.
    """
    _, document = read_layout(text, "the file")
    way = find_way(document, path, model)
    if isinstance(value, str) and takes_list(model, way.keys, document):
        value = [parse_value(word) for word in value.replace(",", " ").split()]
    if way.exists:
        return replace_value(text, way.keys, value)
    if way.widen is not None:
        keys, key = way.widen
        text = replace_value(text, keys, {key: _look(document, keys)})
    return insert_at(text, way.keys, value, model)


def reset_value(text: str, path: str, model: type[BaseModel] = Profile) -> str:
    """Returns the text without the value at the place a person names, so that the default applies.

    Raises:
        ProfileError: the path leads nowhere, or nothing is there.
    """
    _, document = read_layout(text, "the file")
    way = find_way(document, path, model)
    if not way.exists:
        raise ProfileError(f"'{path}' is not set, its default applies already.")
    return remove_value(text, way.keys)


def take_back(
    text: str, before: str, after: str, names: Collection[str], model: type[BaseModel] = Profile
) -> str:
    """Returns the text with some values as they were before a change, and all else as it is.

    Args:
        text: the file now.
        before: the file when the change began.
        after: the file when it was saved. What was changed again since then stays.
        names: the values, as people name them.
        model: what the file is.
    """
    now, old, new = (read_layout(each, "the file")[1] for each in (text, before, after))
    for name in names:
        keys = tuple(name.split("."))
        was, became, is_ = (_find(each, keys) for each in (old, new, now))
        if was == became or is_ != became:
            continue
        text = reset_value(text, name, model) if was is None else set_value(text, name, was, model)
    return text


def _find(document: Any, keys: Keys) -> Any:
    for key in keys:
        document = document.get(key) if isinstance(document, dict) else None
    return document


def insert_at(text: str, keys: Keys, value: Any, model: type[BaseModel] = Profile) -> str:
    """Returns the text with a value at a new place, with the mappings that are missing."""
    _, document = read_layout(text, "the file")
    n = len(keys) - 1
    while n and _look(document, keys[:n]) is None:
        value, n = {keys[n]: value}, n - 1
    parent = _look(document, keys[:n])
    return insert_key(text, keys[:n], str(keys[n]), value, list_known(parent, keys[:n], model))


def bind(text: str, when: Any, do: Any, layer: str | None = None, *, add: bool = False) -> str:
    """Returns the text with a binding; one for the same ``when`` gets a new ``do`` instead.

    Args:
        text: the profile.
        when: a gesture as a profile writes it.
        do: an output as a profile writes it.
        layer: the name of the layer; by default the first one.
        add: keep one for the same ``when`` beside it.

    Raises:
        ProfileError: there is no such layer.
    """
    _, document = read_layout(text, "the file")
    keys = find_bindings(document, layer)
    bindings = _look(document, keys)
    if bindings is None:
        return insert_at(text, keys, [{"when": when, "do": do}])
    same = [i for i, binding in enumerate(bindings) if _is_same(binding["when"], when)]
    if same and not add:
        return replace_value(text, (*keys, same[0], "do"), do)
    return append_item(text, keys, {"when": when, "do": do})


def list_namesakes(text: str, path: str, model: type[BaseModel] = Profile) -> list[str]:
    """Returns the bindings with the same gesture as the one a path leads to, that one first.

    Empty if the path leads to no binding, or to the only one of its gesture.
    """
    _, document = read_layout(text, "the file")
    keys = find_way(document, path, model).keys
    if "bindings" not in keys[:-1]:
        return []
    at = keys.index("bindings") + 1
    bindings = _look(document, keys[:at])
    names = name_bindings(bindings)
    gesture = names[int(keys[at])].partition("#")[0]
    same = [
        f"{name} ({_describe_do(binding['do'])})"
        for name, binding in zip(names, bindings, strict=True)
        if name.partition("#")[0] == gesture and binding is not bindings[int(keys[at])]
    ]
    own = f"{names[int(keys[at])]} ({_describe_do(bindings[int(keys[at])]['do'])})"
    return [own, *same] if same else []


def _describe_do(do: Any) -> str:
    return " ".join(map(str, next(iter(do.items()))))


def list_company(text: str, when: Any, layer: str | None = None) -> list[str]:
    """Returns a layer's other bindings for the gesture of ``when``, as ``pinch (trigger left)``.

    Raises:
        ProfileError: there is no such layer.
    """
    _, document = read_layout(text, "the file")
    bindings = _look(document, find_bindings(document, layer)) or []
    gesture = _say(when).get("gesture")
    return [
        f"{name} ({_describe_do(binding['do'])})"
        for name, binding in zip(name_bindings(bindings), bindings, strict=True)
        if gesture is not None
        and _say(binding["when"]).get("gesture") == gesture
        and not _is_same(binding["when"], when)
    ]


def unbind(text: str, when: Any, do: Any = None, layer: str | None = None) -> str:
    """Returns the text without the bindings for ``when``, or only without those that do ``do``.

    Raises:
        ProfileError: there is no such layer or binding, or it is the last one.
    """
    _, document = read_layout(text, "the file")
    keys = find_bindings(document, layer)
    bindings = _look(document, keys) or []
    gone = [
        i
        for i, binding in enumerate(bindings)
        if _is_same(binding["when"], when) and (do is None or _is_part(do, binding["do"]))
    ]
    if not gone:
        names = ", ".join(name_bindings(bindings))
        raise ProfileError("There is no such binding.", hint=f"Bindings here: {names or 'none'}.")
    if len(gone) == len(bindings):
        raise ProfileError(
            "The last binding of a layer cannot be removed.", hint="Bind something else first."
        )
    for i in reversed(gone):
        text = remove_value(text, (*keys, i))
    return text


def rebind(
    text: str, when: Any, do: Any, layer: str | None = None, *, instead: str | None = None
) -> str:
    """Returns the text with a binding that takes the place of another one.

    Args:
        text: the profile.
        when: a gesture as a profile writes it.
        do: an output as a profile writes it.
        layer: the name of the layer; by default the first one.
        instead: the path of the binding it replaces; None: of none.

    Raises:
        ProfileError: there is no such layer or binding.
    """
    if instead is None:
        return bind(text, when, do, layer, add=True)
    _, document = read_layout(text, "the file")
    keys = find_way(document, instead).keys
    old = _look(document, keys)
    if not isinstance(old, dict) or "when" not in old:
        raise ProfileError(f"'{instead}' is no binding.")
    if _is_same(old["when"], when):
        return replace_value(text, (*keys, "do"), do)
    return remove_value(append_item(text, keys[:-1], {"when": when, "do": do}), keys)


def remove_binding(text: str, path: str) -> str:
    """Returns the text without the binding a path leads to.

    Raises:
        ProfileError: there is none, or it is the last one of its layer.
    """
    _, document = read_layout(text, "the file")
    keys = find_way(document, path).keys
    siblings = _look(document, keys[:-1])
    if not isinstance(siblings, list):
        raise ProfileError(f"'{path}' is no binding.")
    if len(siblings) == 1:
        raise ProfileError(
            "The last binding of a layer cannot be removed.", hint="Bind something else first."
        )
    return remove_value(text, keys)


def find_bindings(document: Any, layer: str | None) -> Keys:
    """Returns the way to the bindings of a layer; of the first one without a name.

    Raises:
        ProfileError: there is no such layer.
    """
    layers = document.get("layers", [])
    names = [str(inner.get("name")) for inner in layers]
    if layer in names:
        return ("layers", names.index(layer), "bindings")
    if layer is None or layer == "base":
        return ("bindings",) if "bindings" in document or not layers else ("layers", 0, "bindings")
    near = suggest(layer, names)
    raise ProfileError(
        f"There is no layer '{layer}'.",
        hint=near[:1].upper() + near[1:]
        or (f"Layers: {', '.join(names)}." if names else "This profile has none: name no layer."),
    )


def adopt(text: str, name: str, schema: str) -> str:
    """Returns the text for another folder, with its ``name`` and schema line corrected.

    Args:
        text: the profile.
        name: what it is to be called.
        schema: the path of the schema, as seen from its new folder.
    """
    first, newline, rest = text.partition("\n")
    if first.startswith(MODELINE):
        text = MODELINE + schema + ("\r" if first.endswith("\r") else "") + newline + rest
    _, document = read_layout(text, name)
    if isinstance(document, dict) and "name" in document and document["name"] != name:
        return replace_value(text, ("name",), name)
    return text


def forget_schema(text: str) -> str:
    """Returns the text without a path of this machine in its schema line."""
    first, newline, rest = text.partition("\n")
    if not first.startswith(MODELINE):
        return text
    name = first.removeprefix(MODELINE).strip().rsplit("/", 1)[-1]
    return f"{MODELINE}{name}{newline}{rest}"


def upgrade(text: str, schema: str) -> str:
    """Returns the text in the current version of the format, with a schema line for editors.

    Raises:
        ProfileError: it is of a version we do not know.
    """
    _, document = read_layout(text, "the file")
    if not isinstance(document, dict):
        raise ProfileError("The file is not a profile.")
    version = document.get("version", 0)
    if version not in range(VERSION + 1):
        raise ProfileError(
            f"The file is of version {version}, this program knows {VERSION}.",
            hint="Update the program.",
        )
    if version == 0:  # files from before there were versions
        text = remove_value(text, ("version",)) if "version" in document else text
        begin = read_layout(text, "the file")[0].begin
        text = f"{text[:begin]}version: {VERSION}\n{text[begin:]}"
    if MODELINE not in text:
        text = f"{MODELINE}{schema}\n{text}"
    return text


def _look(document: Any, keys: Keys) -> Any:
    for key in keys:
        if isinstance(document, dict) and key not in document:
            return None
        document = document[key]
    return document


def _is_same(when: Any, named: Any) -> bool:
    """Returns True if people say both in the same words.

    Thresholds and times beyond those do not count.
    """
    return _say(when) == _say(named)


def _say(when: Any) -> dict[str, Any]:
    narrowed = {"gesture": when} if isinstance(when, str) else when
    return {key: value for key, value in narrowed.items() if key in SPOKEN}


def _is_part(do: dict[str, Any], whole: dict[str, Any]) -> bool:
    return all(whole.get(key) == value for key, value in do.items())
