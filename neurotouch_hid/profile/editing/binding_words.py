"""Bindings as people say them, worded like ``description``: ``push left tap``, ``toggle button a``.

When: a gesture, then any of a direction, ``at the ZONE``, ``with 2 fingers``, ``soft``, ``hard``,
``tap``, ``double``, ``hold``, ``long``, ``from 7 mm``; or gestures joined by ``then``.
Do: ``stick left``, ``axis right_x -``, ``trigger right``, ``button a``, ``dpad up``,
``key ctrl+c``, ``mouse left``, ``mouse pointer``, ``mouse wheel``, ``layer NAME``, ``pause``,
``panic``, ``rezero``, ``next profile``; before it a mode: ``toggle``, ``sticky``, ``oneshot``,
``turbo``.
"""

import re
from typing import Any, Final, get_args

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.faults import suggest
from neurotouch_hid.printable import make_printable
from neurotouch_hid.profile.editing.yaml_values import parse_value
from neurotouch_hid.profile.schema.conditions import CONDITION_KEYS, GestureName, PressName, Zone
from neurotouch_hid.profile.schema.targets import TARGETS, CommandName, EightWay, ModeName

_GESTURES: Final = sorted(get_args(GestureName), key=len, reverse=True)
_WAYS: Final = sorted(get_args(EightWay), key=len, reverse=True)
_COMMANDS: Final = get_args(CommandName)
_MODES: Final = get_args(ModeName)
_KEYS: Final = {
    **dict.fromkeys(_WAYS, "direction"),
    **dict.fromkeys(get_args(PressName), "press"),
    **dict.fromkeys(("soft", "hard"), "level"),
}
_AFTER_GESTURE: Final = (
    "After the gesture comes a direction (up, down, left, right), tap, double, hold, long, soft or "
    'hard. What it does is a word of its own, for example: "pinch tap" "button a".'
)
_ACTIONS: Final = (
    "An action is stick, axis, trigger, button, dpad, key, mouse or layer and which one, for "
    'example "button a"; or pause, panic, rezero or "next profile".'
)
_EXAMPLES: Final = {
    "stick": "stick left",
    "axis": "axis right_x +",
    "trigger": "trigger right",
    "button": "button a",
    "dpad": "dpad up",
    "key": "key space",
    "mouse": "mouse left",
    "layer": "layer menu",
}
_LONG: Final = {
    r"\bat (?:the )?(\w+)\b": "zone",
    r"\bwith (\d+) fingers?\b": "contacts",
    r"\bwhile (\w+) is held\b": "with_button",
    r"\bfrom ([\d.]+) ?mm\b": "on_mm",
    r"\bin (?:its )?(\w+)\b": "phase",
}


def parse_when(words: str) -> Any:
    """Returns the value of ``when`` as a profile writes it.

    Raises:
        ProfileError: the words mean no gesture.
    """
    if words.lstrip().startswith("{"):
        return parse_value(words)
    if " then " in words:
        return {"sequence": [_join(step) for step in words.split(" then ")]}
    rest, found = words.lower(), {}
    for pattern, key in _LONG.items():
        hit = re.search(pattern, rest)
        if hit is not None:
            value = hit[1]
            found[key] = int(value) if key == "contacts" else value
            if key == "on_mm":
                found[key] = parse_value(value)
            rest = rest[: hit.start()] + rest[hit.end() :]
    if found.get("zone") not in (None, *get_args(Zone)):
        raise _refuse(words, str(found["zone"]), get_args(Zone))
    gesture, *others = _split(rest, [*_GESTURES, *_KEYS]) or [""]
    if gesture not in _GESTURES:
        raise _refuse(words, gesture, _GESTURES)
    for word in others:
        if word not in _KEYS or _KEYS[word] in found:
            raise _refuse(words, word, list(_KEYS), _AFTER_GESTURE)
        found[_KEYS[word]] = word
    narrowed = {key: found[key] for key in CONDITION_KEYS if key in found}
    return {"gesture": gesture, **narrowed} if narrowed else gesture


def parse_do(words: str) -> dict[str, Any]:
    """Returns the value of ``do`` as a profile writes it.

    Raises:
        ProfileError: the words mean no output.
    """
    if words.lstrip().startswith("{"):
        value = parse_value(words)
        return value if isinstance(value, dict) else {}
    parts = words.lower().split()
    command = _join(words)
    if command in _COMMANDS:
        return {"command": command}
    mode = {"mode": parts.pop(0)} if parts and parts[0] in _MODES else {}
    if len(parts) == 1 and parts[0] in _EXAMPLES:
        raise ProfileError(
            f"'{make_printable(words[:80])}' does not say which {parts[0]}.",
            hint=f"For example: {_EXAMPLES[parts[0]]}.",
        )
    if len(parts) < 2 or parts[0] not in TARGETS:
        known = [name for name in TARGETS if name != "command"]  # which are words of their own
        known += [*_COMMANDS, *_MODES]
        raise _refuse(words, parts[0] if parts else "", known, _ACTIONS)
    target, *what = parts
    if target == "axis" and what[-1] in ("+", "-") and len(what) > 1:
        return {"axis": "_".join(what[:-1]), "sign": what[-1], **mode}
    name = "_".join(what)
    return {target: "motion" if (target, name) == ("mouse", "pointer") else name, **mode}


def _join(words: str) -> str:
    return "_".join(words.lower().split())


def _split(words: str, known: list[str]) -> list[str]:
    """Returns the words, with those that belong together joined: ``twist cw`` is ``twist_cw``."""
    line = "_".join(words.replace("-", "_").split())
    found = []
    longest = sorted(known, key=len, reverse=True)
    while line:
        word = next((w for w in longest if line == w or line.startswith(f"{w}_")), None)
        word = word if word is not None else line.partition("_")[0]
        found.append(word)
        line = line[len(word) :].lstrip("_")
    return found


def _refuse(words: str, word: str, known: Any, help_: str = "") -> ProfileError:
    """Returns the error about a word; without a near one its fix is ``help_``, or all words."""
    shown, near = make_printable(words[:80]), suggest(word, list(known)) if word else ""
    choice = help_ or f"Known: {', '.join(known)}."
    part = make_printable(word[:40])
    return ProfileError(
        f"'{shown}' is not understood" + (f": '{part}'." if part not in ("", shown) else "."),
        hint=near[:1].upper() + near[1:] or choice,
    )
