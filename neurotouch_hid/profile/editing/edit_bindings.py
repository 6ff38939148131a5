"""Binds and unbinds gestures, and says which bindings belong to one gesture."""

from typing import Any, Final

from pydantic import BaseModel

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.faults import Keys, suggest
from neurotouch_hid.profile.editing.edit_values import insert_value
from neurotouch_hid.profile.editing.key_paths import find_key_path, name_bindings
from neurotouch_hid.profile.editing.profile_text import ProfileText
from neurotouch_hid.profile.schema.conditions import CONDITION_KEYS
from neurotouch_hid.profile.schema.profile import Profile

SPOKEN: Final = ("sequence", *CONDITION_KEYS)
"""The keys of ``when`` that tell bindings apart for people."""


def bind(
    text: ProfileText, when: Any, do: Any, layer: str | None = None, *, add: bool = False
) -> ProfileText:
    """Returns the text with a binding; one for the same ``when`` gets a new ``do`` instead.

    Args:
        text: the profile.
        when: a gesture as a profile writes it; without a threshold, it means that of any.
        do: an output as a profile writes it.
        layer: the name of the layer; by default the first one.
        add: keep one for the same ``when`` beside it.

    Raises:
        ProfileError: there is no such layer, or several bindings could be meant.
    """
    keys = locate_bindings(text.document, layer)
    bindings = text.find(keys)
    if bindings is None:
        return insert_value(text, keys, [{"when": when, "do": do}])
    same = _find_meant(bindings, when)
    if same and not add:
        thresholds = [_say(bindings[i]["when"]).get("on_mm") for i in same]
        if len(set(thresholds)) > 1:
            raise ProfileError(
                "This gesture has several bindings, each with a threshold of its own.",
                hint=f'Say which, in quotes, as in: "pinch from {thresholds[0]} mm".',
            )
        return text.replace((*keys, same[0], "do"), do)
    return text.append(keys, {"when": when, "do": do})


def list_namesakes(text: ProfileText, path: str, model: type[BaseModel] = Profile) -> list[str]:
    """Returns the bindings with the same gesture as the one a path leads to, that one first.

    Empty if the path leads to no binding, or to the only one of its gesture.
    """
    keys = find_key_path(text.document, path, model).keys
    if "bindings" not in keys[:-1]:
        return []
    n = keys.index("bindings") + 1
    bindings, at = text.find(keys[:n]), int(keys[n])
    said = _describe_bindings(bindings)
    gestures = [name.partition("#")[0] for name in name_bindings(bindings)]
    same = [said[i] for i, name in enumerate(gestures) if name == gestures[at] and i != at]
    return [said[at], *same] if same else []


def list_company(
    text: ProfileText, when: Any, layer: str | None = None, *, added: bool = False
) -> list[str]:
    """Returns a layer's other bindings for the gesture of ``when``, as ``pinch (trigger left)``.

    Args:
        text: the profile, with the binding.
        when: its condition.
        layer: the name of the layer; by default the first one.
        added: the binding stands beside others of the same condition, which count too.

    Raises:
        ProfileError: there is no such layer.
    """
    bindings = text.find(locate_bindings(text.document, layer)) or []
    gesture, meant = _say(when).get("gesture"), _find_meant(bindings, when)
    meant = meant[-1:] if added else meant
    return [
        said
        for i, said in enumerate(_describe_bindings(bindings))
        if gesture is not None
        and _say(bindings[i]["when"]).get("gesture") == gesture
        and i not in meant
    ]


def unbind(text: ProfileText, when: Any, do: Any = None, layer: str | None = None) -> ProfileText:
    """Returns the text without the bindings for ``when``, or only without those that do ``do``.

    Args:
        text: the profile.
        when: a gesture as a profile writes it, or one binding by its name, ``pinch#2``.
        do: an output as a profile writes it, or a part of it.
        layer: the name of the layer; by default the first one.

    Raises:
        ProfileError: there is no such layer or binding, or it is the last one.
    """
    keys = locate_bindings(text.document, layer)
    bindings = text.find(keys) or []
    names = name_bindings(bindings)
    numbered = isinstance(when, str) and "#" in when
    meant = (
        [i for i, name in enumerate(names) if name == when]
        if numbered
        else _find_meant(bindings, when)
    )
    gone = [i for i in meant if bindings[i]["do"] == {**bindings[i]["do"], **(do or {})}]
    if not gone:
        known = ", ".join(names) or "none"
        raise ProfileError("There is no such binding.", hint=f"Bindings here: {known}.")
    return _remove(text, keys, gone)


def rebind(
    text: ProfileText, when: Any, do: Any, layer: str | None = None, *, instead: str | None = None
) -> ProfileText:
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
    keys = find_key_path(text.document, instead).keys
    old = text.find(keys)
    if not isinstance(old, dict) or "when" not in old:
        raise ProfileError(f"'{instead}' is no binding.")
    if _find_meant([old], when):
        return text.replace((*keys, "do"), do)
    return text.append(keys[:-1], {"when": when, "do": do}).remove(keys)


def remove_binding(text: ProfileText, path: str) -> ProfileText:
    """Returns the text without the binding a path leads to.

    Raises:
        ProfileError: there is none, or it is the last one of its layer.
    """
    keys = find_key_path(text.document, path).keys
    if not isinstance(text.find(keys[:-1]), list):
        raise ProfileError(f"'{path}' is no binding.")
    return _remove(text, keys[:-1], [int(keys[-1])])


def locate_bindings(document: Any, layer: str | None) -> Keys:
    """Returns the path of a layer's bindings; without a name, of the first layer's.

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


def _remove(text: ProfileText, keys: Keys, gone: list[int]) -> ProfileText:
    """Returns the text without some bindings of the list at ``keys``."""
    if len(gone) == len(text.find(keys)):
        raise ProfileError(
            "The last binding of a layer cannot be removed.", hint="Bind something else first."
        )
    for i in reversed(gone):
        text = text.remove((*keys, i))
    return text


def _say(when: Any) -> dict[str, Any]:
    """Returns the part of a condition that people say; what is said alike is the same to them."""
    narrowed = {"gesture": when} if isinstance(when, str) else when
    return {key: value for key, value in narrowed.items() if key in SPOKEN}


def _find_meant(bindings: Any, when: Any) -> list[int]:
    """Returns which bindings a condition means; one without a threshold means those of any.

    Where one has none either, it is meant alone.
    """
    said = [_say(binding["when"]) for binding in bindings]
    exact = [i for i, each in enumerate(said) if each == _say(when)]
    anyhow = [
        i for i, each in enumerate(said) if {**each, "on_mm": None} == {**_say(when), "on_mm": None}
    ]
    return exact if exact or "on_mm" in _say(when) else anyhow


def _describe_bindings(bindings: Any) -> list[str]:
    """Names bindings, each with its output: ``pinch (trigger left)``."""
    outputs = (" ".join(map(str, next(iter(binding["do"].items())))) for binding in bindings)
    return [f"{name} ({do})" for name, do in zip(name_bindings(bindings), outputs, strict=True)]
