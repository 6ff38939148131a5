"""Describes a profile for the page: its bindings, their marks, and which of them can be changed."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NotRequired, TypedDict, get_args

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.faults import describe_fault
from neurotouch_hid.page.own_values import load_usable_user
from neurotouch_hid.players import find_user_file
from neurotouch_hid.profile import Checked, check_profile
from neurotouch_hid.profile.diagnostics import (
    describe_condition,
    describe_target,
    describe_when,
)
from neurotouch_hid.profile.editing import Store, name_bindings, take_profile
from neurotouch_hid.profile.engine import FILTERS, OneEuro, make_response
from neurotouch_hid.profile.reading import find_shipped_folder, list_profile_folders
from neurotouch_hid.profile.schema import (
    FIRST_LAYER,
    Binding,
    Condition,
    Expo,
    FilterName,
    MovementName,
    Points,
    Power,
    Profile,
    SafetyGesture,
    Shaped,
    choose_filter,
    merge_bindings,
)
from neurotouch_hid.vocabulary import GestureKind

MOVEMENTS: Final = get_args(MovementName)
"""The eight bars, by the names of the person's ranges."""

SAMPLES: Final = 33
"""Points of a response curve."""

_STOPS: Final = {
    "pause": "pauses everything; the same again resumes",
    "panic": "stops everything; Resume on the page goes on",
}
"""What the movements under ``safety:`` do, in the page's words."""

PRESS_MM: Final = 5.0
PRESS_MS: Final = 300
"""The press whose delay measures a filter's lag."""


@dataclass(frozen=True, slots=True)
class Place:
    """Place of a binding in the profile's own file.

    Attributes:
        key: its key for ``set_value``, such as ``layers.menu.pinch``.
        binding: the binding.
    """

    key: str
    binding: Binding


class BindingView(TypedDict):
    """A binding for the page, with the marks that it has.

    Attributes:
        key: its key for ``set_value``; None if it is in another profile.
        when: the movement in words.
        do: the output in words.
        movements: the bars that show it.
        on_mm: the intensity at which it acts.
        off_mm: the intensity at which it releases.
        unit: unit of ``rest`` and ``full``: ``mm`` or ``mm/s``.
        rest: the start of its range.
        full: the end of its range.
        most: the end of the drawn curve.
        samples: the curve, evenly from 0 to ``most``.
        curve: its one number or its points, by name; missing if it cannot be dragged.
    """

    key: str | None
    when: str
    do: str
    movements: list[str]
    on_mm: NotRequired[float]
    off_mm: NotRequired[float]
    unit: NotRequired[str]
    rest: NotRequired[float]
    full: NotRequired[float]
    most: NotRequired[float]
    samples: NotRequired[list[float]]
    curve: NotRequired[dict[str, float | list[tuple[float, float]]]]


class LayerView(TypedDict):
    """A layer: its name, and its bindings."""

    name: str
    bindings: list[BindingView]


class StopView(TypedDict):
    """A movement that stops everything, in every layer.

    Attributes:
        when: the movement in words, with how long it is held.
        does: what it does, in words.
        movements: the bars that show it.
    """

    when: str
    does: str
    movements: list[str]


class ProfileView(TypedDict):
    """A profile for the page.

    Attributes:
        profile: its name.
        description: its purpose.
        shipped: it came with the program.
        edit: the page may change it.
        filter: the tremor filter.
        filter_ms: by how much that delays a press, in ms.
        resting: the neutral pose is that of a resting hand.
        ranges: the person's own ranges, by movement.
        stops: the movements that stop everything.
        layers: its layers, the first one first.
        can_undo: the page may undo a change of it.
    """

    profile: str
    description: str
    shipped: bool
    edit: bool
    filter: str
    filter_ms: float
    resting: bool
    ranges: dict[str, dict[str, float]]
    stops: list[StopView]
    layers: list[LayerView]
    can_undo: bool


class ProfileFault(TypedDict):
    """A profile that cannot be shown, with the reason.

    Attributes:
        fault: the reason.
        can_undo: the page may undo a change of it.
    """

    fault: str
    can_undo: bool


def require_usable(checked: Checked[Profile], name: str) -> Profile:
    """Returns a profile that has been checked.

    Raises:
        ProfileError: it has errors; the message is one to be read aloud, without marked lines.
    """
    if checked.whole is None:
        fault = next(each for each in checked.faults if each.severity == "error")
        raise ProfileError(f"The profile '{name}' cannot be used. {describe_fault(fault)}")
    return checked.whole


def describe_profile(path: Path, *, edit: bool) -> ProfileView:
    """Returns a profile for the page, ready for JSON.

    Args:
        path: its file.
        edit: True if changes are allowed.

    Raises:
        ProfileError: the file cannot be used.
    """
    user = load_usable_user()
    checked = check_profile(path)
    profile = require_usable(checked, path.stem)
    places = list_places(checked.written) if isinstance(checked.written, Profile) else []
    filter_name = choose_filter(profile, user)
    return {
        "profile": profile.name,
        "description": profile.description,
        "shipped": path.parent == find_shipped_folder().resolve(),
        "edit": edit and is_editable(path),
        "filter": filter_name,
        "filter_ms": measure_lag(filter_name),
        "resting": user.neutral == "resting",
        "ranges": user.range.model_dump(exclude_none=True),
        "stops": [
            _describe_stop(gesture, does)
            for name, does in _STOPS.items()
            if (gesture := getattr(profile.safety, name)) is not None
        ],
        "layers": [
            {
                "name": layer.name,
                "bindings": [
                    _describe_binding(binding, _find_key(binding, layer.name, places))
                    for binding in merge_bindings(layer, profile.all_layers[0])
                ],
            }
            for layer in profile.all_layers
        ],
        "can_undo": edit and can_undo(path),
    }


def list_files(path: Path) -> list[Path]:
    """Returns the files that decide what is shown of a profile; each may be missing."""
    return [path, find_user_file(), Store(path, str).undone_file]


def can_undo(path: Path) -> bool:
    """Returns whether a profile that the page may change has a change to undo."""
    try:
        return is_editable(path) and take_profile(path.stem, str).store.can_undo()
    except ProfileError:
        return False


def is_editable(path: Path) -> bool:
    """Returns True for profiles in one of the profile folders.

    The page changes no other file.
    """
    folders = {folder.resolve() for folder in list_profile_folders()}
    return path.parent in folders and path.suffix == ".yaml"


def list_places(written: Profile) -> list[Place]:
    """Returns every binding of the profile's own file, with its key."""
    places = []
    for layer in written.all_layers:
        documents = [binding.model_dump(exclude_unset=True) for binding in layer.bindings]
        prefix = f"layers.{layer.name}."
        if written.bindings is not None and layer.name == FIRST_LAYER:
            prefix = ""
        names = name_bindings(documents)
        places += [
            Place(prefix + name, binding)
            for name, binding in zip(names, layer.bindings, strict=True)
        ]
    return places


def say_when(words: str) -> str:
    """Returns a condition as a screen reader can say it: ``twist clockwise`` for ``twist cw``."""
    return words.replace("twist ccw", "twist counter-clockwise").replace(
        "twist cw", "twist clockwise"
    )


def measure_lag(name: FilterName) -> float:
    """Returns the delay by a filter, in ms, at the middle of a press of 5 mm in 300 ms."""
    if name not in FILTERS:
        return 0.0
    smooth = OneEuro(*FILTERS[name])
    before = 0.0
    for t_ms in range(0, 4 * PRESS_MS, 10):
        s = min(t_ms / PRESS_MS, 1.0)
        value = smooth.update(PRESS_MM * s**3 * (10.0 - 15.0 * s + 6.0 * s * s), 10_000)
        if value >= 0.5 * PRESS_MM:
            crossed_ms = t_ms - 10.0 * (value - 0.5 * PRESS_MM) / (value - before)
            return round(crossed_ms - 0.5 * PRESS_MS, 1)
        before = value
    return math.inf


def _find_key(binding: Binding, layer: str, places: list[Place]) -> str | None:
    """Returns the key of a binding; None if it is in a profile that this one is based on."""
    same = [place.key for place in places if place.binding == binding]
    inside = [key for key in same if key.startswith(f"layers.{layer}.")]
    return next(iter(inside or same), None)


def _describe_binding(binding: Binding, key: str | None) -> BindingView:
    condition = binding.condition
    view: BindingView = {
        "key": key,
        "when": say_when(describe_when(binding)),
        "do": describe_target(binding.do),
        "movements": _list_movements(condition),
    }
    on_mm, off_mm = binding.thresholds_mm
    if on_mm:
        view |= {"on_mm": on_mm, "off_mm": round(off_mm, 2)}
    if isinstance(binding.do, Shaped) and binding.is_followed:
        _add_response(view, binding, condition.kinds[0], binding.do)
    return view


def _describe_stop(gesture: SafetyGesture, does: str) -> StopView:
    condition = gesture.condition
    words = say_when(describe_condition(condition.model_copy(update={"press": None})))
    if gesture.gesture == "any":
        words = words.replace("any", "any movement", 1)
    return {
        "when": f"{words}, held for {gesture.hold_ms / 1000:g} s",
        "does": does,
        "movements": _list_movements(condition),
    }


def _add_response(view: BindingView, binding: Binding, kind: GestureKind, do: Shaped) -> None:
    """Adds the range and the curve of a binding that follows the gesture."""
    rest, full = binding.range_for(kind)
    respond = make_response((rest, full), do)
    most = 1.25 * full
    view |= {
        "unit": "mm/s" if getattr(do, "follow", "") == "speed" else "mm",
        "rest": rest,
        "full": full,
        "most": round(most, 2),
        "samples": [round(respond(most * i / (SAMPLES - 1)), 4) for i in range(SAMPLES)],
    }
    match do.curve:
        case Expo(expo=expo):
            view["curve"] = {"expo": expo}
        case Power(power=power):
            view["curve"] = {"power": power}
        case Points(points=points):
            view["curve"] = {"points": points}
        case _:
            view["curve"] = {"expo": 0.0}


def _list_movements(condition: Condition) -> list[str]:
    """Returns the bars that show a condition."""
    kinds = [kind.label for kind in condition.kinds]
    return [movement for movement in MOVEMENTS if _fits(movement, kinds, condition.direction)]


def _fits(movement: str, kinds: list[str], direction: str | None) -> bool:
    """Returns True if the bar of a movement shows a binding.

    Two bars show a diagonal.
    """
    gesture = "push" if movement.startswith("push") else movement
    if gesture not in kinds:
        return False
    return gesture != "push" or direction is None or movement.removeprefix("push_") in direction
