"""Saves changes from the page: bindings of the active profile, with their marks and curves."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from neurotouch_hid.client import ask
from neurotouch_hid.errors import DriverError, NotRunningError, ProfileError
from neurotouch_hid.page.handed_over import describe_effect, pass_on
from neurotouch_hid.page.profile_view import (
    Place,
    is_editable,
    list_places,
    require_usable,
    say_when,
)
from neurotouch_hid.page.reading import read_number
from neurotouch_hid.profile import Profile, check_profile, list_profiles, load_unused
from neurotouch_hid.profile.diagnostics import describe_target, describe_when
from neurotouch_hid.profile.editing import (
    EditedFile,
    ProfileText,
    hand_over_restored,
    make_favourite,
    make_profile,
    parse_do,
    parse_when,
    rebind,
    remap_unused,
    remove_binding,
    set_value,
    take_profile,
)
from neurotouch_hid.profile.reading import OWN_VALUES
from neurotouch_hid.profile.schema import MOVEMENTS, Binding

MARKS: Final = {
    "on_mm": "acts from {} mm",
    "off_mm": "releases below {} mm",
    "rest": "begins at {}",
    "full": "ends at {}",
    "expo": "has a bend of {}",
    "power": "has a bend of {}",
    "points": "has a curve of its own",
}
"""The marks that can be changed, and the page's words for each."""

_MOST_NAMED: Final = 3


@dataclass(frozen=True, slots=True)
class Wish:
    """A binding that a browser requests.

    Attributes:
        movement: one of the eight.
        press: ``tap``, ``double``, ``hold``, ``long``, or empty: as long as the movement lasts.
        mode: ``toggle`` and so on, or empty.
        do: the output as ``parse_do`` takes it.
        layer: the layer; empty: the first.
        instead: the key of the binding that it replaces; empty: of none.
    """

    movement: str
    press: str
    mode: str
    do: str
    layer: str
    instead: str


class Changes:
    """Saves changes to profiles; each save is a version that can be undone.

    Args:
        stamp: returns the present time, for the names of versions.
    """

    def __init__(self, stamp: Callable[[], str]) -> None:
        self._stamp = stamp

    def set(self, path: Path, key: str, mark: str, value: Any) -> str:
        """Sets one mark; returns a sentence about the saved change.

        Args:
            path: the profile's file, as the driver names it.
            key: the way to the binding.
            mark: one of ``MARKS``.
            value: millimetres, the curve's number, or its points.

        Raises:
            ProfileError: there is no such mark, or the value is not possible; nothing has changed.
            PageError: the value is not a number; nothing has changed.
            DriverError: it is saved, but the running driver does not use it.
        """
        edited = self._take(path)
        place = _find_place(path, key)
        text = _write(edited.text, place, mark, value)
        if text == edited.text:
            return f"{edited.name} has this value already."
        _save(edited, text)
        said = _describe(place.binding, mark, value)
        return f"Saved in {edited.name}: {said}. {pass_on(edited.name)}"

    def bind(self, path: Path, wish: "Wish") -> str:
        """Binds a movement to an output; returns a sentence about the saved change.

        Raises:
            ProfileError: there is no such movement, output or binding; nothing has changed.
            DriverError: it is saved, but the running driver does not use it.
        """
        edited = self._take(path)
        text = rebind(
            edited.text,
            parse_when(f"{wish.movement.replace('_', ' ')} {wish.press}".strip()),
            parse_do(f"{wish.mode} {wish.do}".strip()),
            wish.layer or None,
            instead=wish.instead or None,
        )
        _save(edited, text)
        words = MOVEMENTS[wish.movement].words if wish.movement in MOVEMENTS else wish.movement
        made = f"{words} {wish.press}".rstrip()
        return f"Saved in {edited.name}: {made} → {wish.do}. {pass_on(edited.name)}"

    def unbind(self, path: Path, key: str) -> str:
        """Removes a binding.

        Raises:
            ProfileError: there is no such binding, or it is the last one; nothing has changed.
            DriverError: as ``bind``.
        """
        edited = self._take(path)
        _save(edited, remove_binding(edited.text, key))
        return f"Removed from {edited.name}. {pass_on(edited.name)}"

    def use(self, name: str) -> str:
        """Switches to a profile; returns nothing if a driver plays it now: its state says so.

        Raises:
            ProfileError: there is none, or it has errors.
            DriverError: the running driver does not use it.
        """
        require_usable(check_profile(name), name)
        stem, _, _ = make_favourite(name, self._stamp)
        said = pass_on(OWN_VALUES)
        with suppress(NotRunningError):
            ask("use", profile=stem)
            said = ""
        return said

    def copy(self, template: str) -> str:
        """Makes a copy of a profile that the person can change, and switches to it.

        A binding to a movement that the person does not use moves to a free movement, if any.

        Raises:
            ProfileError: there is no such template, or it has errors.
            DriverError: the running driver does not use it.
        """
        require_usable(check_profile(template), template)
        known = list_profiles()
        names = ("mine", *(f"mine-{number}" for number in range(2, len(known) + 3)))
        name = next(name for name in names if name not in known)
        edited = make_profile(name, template, self._stamp)
        edited.save(remap_unused(edited.text, load_unused()).text)
        return f"'{name}' is your own copy of {template}. {self.use(name)}".rstrip()

    def undo(self, path: Path) -> str:
        """Undoes the last change; returns a sentence about it.

        Raises:
            ProfileError: there is none.
            DriverError: as ``set``.
        """
        undone = self._take(path)
        undone.store.undo()
        restored = self._take(path)
        effect = hand_over_restored(restored)
        if effect.status != "OK":
            raise DriverError(f"Back, but not in use. {effect.said}", hint="Press Undo once more.")
        said = describe_effect(effect)
        changed = _name_changed(undone, restored)
        return f"{changed}{restored.name} is as before that change. {said}"

    def _take(self, path: Path) -> EditedFile:
        if not is_editable(path):
            raise ProfileError(
                "This profile is outside your profile folder, so it is not changed from here.",
                hint="Change it with an editor, or import it.",
            )
        return take_profile(path.stem, self._stamp)


def _save(edited: EditedFile, text: ProfileText) -> None:
    """Saves a changed text if it is right.

    Raises:
        ProfileError: it is not; the first mistake is told without its place in the file.
    """
    checked = edited.check(text)
    if checked.whole is None:
        known = {(each.path, each.sentence) for each in edited.check(edited.text).faults}
        errors = [each for each in checked.faults if each.severity == "error"]
        new = [each for each in errors if (each.path, each.sentence) not in known]
        fault = (new or errors)[0]
        hint = f"{fault.hint[:1].upper()}{fault.hint[1:]}"
        raise ProfileError(f"Nothing was saved: {fault.sentence}.", hint=hint or None)
    edited.save(text)


def _describe(binding: Binding, mark: str, value: Any) -> str:
    """Returns for example ``pinch → button a acts from 4.1 mm``."""
    when = say_when(describe_when(binding))
    if (
        binding.condition.on_mm is not None
    ):  # the sentence names it anyway, and it may be the changed value
        when = when.removesuffix(f" from {binding.condition.on_mm:g} mm")
    number = "" if mark == "points" else f"{round(value, 2 if mark in ('expo', 'power') else 1):g}"
    if mark in ("rest", "full"):
        number += " mm/s" if getattr(binding.do, "follow", "") == "speed" else " mm"
    return f"{when} → {describe_target(binding.do)} {MARKS[mark].format(number)}"


def _name_changed(undone: EditedFile, restored: EditedFile) -> str:
    """Returns for example ``Back: pinch → button a. ``; nothing if no binding is known to differ.

    Many are only counted, because a screen reader says them all.
    """
    was, now = _list_bindings(undone), _list_bindings(restored)
    back = [binding for binding in now if binding not in was]
    changed = back or [binding for binding in was if binding not in now]
    if not (was and changed):
        return ""
    named = [f"{say_when(describe_when(each))} → {describe_target(each.do)}" for each in changed]
    said = ", ".join(named) if len(named) <= _MOST_NAMED else f"{len(named)} bindings"
    return f"{'Back' if back else 'Removed'}: {said}. "


def _list_bindings(edited: EditedFile) -> list[Binding]:
    """Returns all bindings of a profile; none if it has errors."""
    written = edited.check(edited.text).written
    return [place.binding for place in list_places(written)] if isinstance(written, Profile) else []


def _find_place(path: Path, key: str) -> Place:
    """Returns the binding of that name from the profile's own file; no other file may change."""
    written = check_profile(path).written
    places = list_places(written) if isinstance(written, Profile) else []
    found = next((place for place in places if place.key == key), None)
    if found is None:
        raise ProfileError("There is no such binding in the active profile.")
    return found


def _write(text: ProfileText, place: Place, mark: str, value: Any) -> ProfileText:
    if mark not in MARKS:
        raise ProfileError("There is no such mark.")
    if mark == "points":
        return set_value(text, f"{place.key}.curve", {"points": _read_points(value)})
    number = read_number(value)
    if mark in ("on_mm", "off_mm"):
        return set_value(text, f"{place.key}.{mark}", round(number, 1))
    if mark in ("rest", "full"):
        rest, full = place.binding.range_for(place.binding.condition.kinds[0])
        moved = (number, full) if mark == "rest" else (rest, number)
        name = "range_mm_s" if getattr(place.binding.do, "follow", "") == "speed" else "range_mm"
        return set_value(text, f"{place.key}.{name}", [round(end, 1) for end in moved])
    curve = getattr(place.binding.do, "curve", "linear")
    if hasattr(curve, mark):
        return set_value(text, f"{place.key}.curve.{mark}", round(number, 2))
    return set_value(text, f"{place.key}.curve", {mark: round(number, 2)})


def _read_points(value: Any) -> list[list[float]]:
    if not isinstance(value, list) or not 1 <= len(value) <= 16:
        raise ProfileError("A curve needs 1 to 16 points.")
    for point in value:
        if not isinstance(point, list) or len(point) != 2:
            raise ProfileError("A point of a curve needs two numbers, [x, y].")
    return [[round(read_number(x), 2), round(read_number(y), 2)] for x, y in value]
