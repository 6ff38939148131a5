"""What the page may change: marks and curves of the bindings of the active profile."""

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from neurotouch_hid.client import ask
from neurotouch_hid.errors import NotRunningError, ProfileError
from neurotouch_hid.page.handed_over import hand_over_now
from neurotouch_hid.page.profile_view import Place, is_editable, list_places
from neurotouch_hid.profile import Profile, check_profile, list_profiles, load_unused
from neurotouch_hid.profile.diagnostics.description import describe_target, describe_when
from neurotouch_hid.profile.editing import (
    EditedFile,
    make_profile,
    parse_do,
    parse_when,
    rebind,
    remap_unused,
    remove_binding,
    set_value,
    take_profile,
)
from neurotouch_hid.profile.editing.favourites import make_favourite
from neurotouch_hid.profile.schema.movements import MOVEMENTS
from neurotouch_hid.profile.schema.profile import Binding

MARKS: Final = {
    "on_mm": "acts from {} mm",
    "off_mm": "releases below {} mm",
    "rest": "begins at {}",
    "full": "ends at {}",
    "expo": "has a bend of {}",
    "power": "has a bend of {}",
    "points": "has a curve of its own",
}
"""What may be changed, and how the page says it."""


@dataclass(frozen=True, slots=True)
class Wish:
    """What a movement is to do.

    Attributes:
        movement: one of the eight.
        press: ``tap``, ``double``, ``hold``, ``long``, or empty for as long as it lasts.
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
    """Saves what has been dragged; each save is a version that can be undone.

    Args:
        stamp: the present moment, for the names of versions.
    """

    def __init__(self, stamp: Callable[[], str]) -> None:
        self._stamp = stamp

    def set(self, path: Path, key: str, mark: str, value: Any) -> str:
        """Sets one mark and tells in a sentence what has been saved.

        Args:
            path: the profile's file, as the driver names it.
            key: the way to the binding.
            mark: one of ``MARKS``.
            value: millimetres, the curve's number, or its points.

        Raises:
            ProfileError: there is no such mark, or the value cannot be; nothing has changed.
            DriverError: it is saved, and the running driver does not play it.
        """
        paper = self._take(path)
        place = _find_place(path, key)
        text = _write(paper.text, place, mark, value)
        if text == paper.text:
            return f"{paper.name} says so already."
        _save(paper, text)
        said = f"Saved in {paper.name}: {_describe(place.binding, mark, value)}."
        return f"{said} {hand_over_now(paper.name)}"

    def bind(self, path: Path, wish: "Wish") -> str:
        """Lets a movement do something and tells in a sentence what has been saved.

        Raises:
            ProfileError: there is no such movement, output or binding; nothing has changed.
            DriverError: it is saved, and the running driver does not play it.
        """
        paper = self._take(path)
        text = rebind(
            paper.text,
            parse_when(f"{wish.movement.replace('_', ' ')} {wish.press}".strip()),
            parse_do(f"{wish.mode} {wish.do}".strip()),
            wish.layer or None,
            instead=wish.instead or None,
        )
        _save(paper, text)
        words = MOVEMENTS[wish.movement].words if wish.movement in MOVEMENTS else wish.movement
        return (
            f"Saved in {paper.name}: {words} {wish.press} → {wish.do}. {hand_over_now(paper.name)}"
        )

    def unbind(self, path: Path, key: str) -> str:
        """Lets a movement no longer do something.

        Raises:
            ProfileError: there is no such binding, or it is the last one; nothing has changed.
            DriverError: as ``bind``.
        """
        paper = self._take(path)
        _save(paper, remove_binding(paper.text, key))
        return f"Removed from {paper.name}. {hand_over_now(paper.name)}"

    def use(self, name: str) -> str:
        """Plays with a profile from now on.

        Raises:
            ProfileError: there is none, or it has errors.
            DriverError: the running driver does not play it.
        """
        stem, _, _ = make_favourite(name, self._stamp)
        said = hand_over_now()
        with suppress(NotRunningError):
            said = str(ask("use", profile=stem)["text"])
        return said

    def copy(self, template: str) -> str:
        """Makes a profile of the person's own as a copy of another, and plays with it.

        What needs a movement that the person does not use goes to another one, if one is free.

        Raises:
            ProfileError: there is no such template.
            DriverError: the running driver does not play it.
        """
        known = list_profiles()
        names = ("mine", *(f"mine-{number}" for number in range(2, len(known) + 3)))
        name = next(name for name in names if name not in known)
        paper = make_profile(name, template, self._stamp)
        paper.save(remap_unused(paper.text, load_unused()).text)
        return f"'{name}' is your own copy of {template}. {self.use(name)}"

    def undo(self, path: Path) -> str:
        """Takes back the last change.

        Raises:
            ProfileError: there is none.
            DriverError: as ``set``.
        """
        paper = self._take(path)
        version = paper.store.undo()
        return f"{paper.name} is as in version {version.number} again. {hand_over_now(paper.name)}"

    def _take(self, path: Path) -> EditedFile:
        if not is_editable(path):
            raise ProfileError(
                "This profile is outside your profile folder, so it is not changed from here.",
                hint="Change it with an editor, or import it.",
            )
        return take_profile(path.stem, self._stamp)


def _save(paper: EditedFile, text: str) -> None:
    """Saves a changed text if it is right.

    Raises:
        ProfileError: it is not; the first mistake is told as people say it, without the file.
    """
    checked = paper.check(text)
    if checked.whole is None:
        known = {(each.path, each.sentence) for each in paper.check(paper.text).faults}
        errors = [each for each in checked.faults if each.severity == "error"]
        new = [each for each in errors if (each.path, each.sentence) not in known]
        fault = (new or errors)[0]
        hint = f"{fault.hint[:1].upper()}{fault.hint[1:]}"
        raise ProfileError(f"Nothing was saved: {fault.sentence}.", hint=hint or None)
    paper.save(text)


def _describe(binding: Binding, mark: str, value: Any) -> str:
    """Returns for example ``pinch → button a acts from 4.1 mm``."""
    when = describe_when(binding)
    if binding.condition.on_mm is not None:  # it is in the words, and may be what has changed
        when = when.removesuffix(f" from {binding.condition.on_mm:g} mm")
    number = "" if mark == "points" else f"{round(value, 2 if mark in ('expo', 'power') else 1):g}"
    if mark in ("rest", "full"):
        number += " mm/s" if getattr(binding.do, "follow", "") == "speed" else " mm"
    return f"{when} → {describe_target(binding.do)} {MARKS[mark].format(number)}"


def _find_place(path: Path, key: str) -> Place:
    """Returns the binding of that name, from the file alone: nothing else is ever touched."""
    written = check_profile(path).written
    places = list_places(written) if isinstance(written, Profile) else []
    found = next((place for place in places if place.key == key), None)
    if found is None:
        raise ProfileError("There is no such binding in the active profile.")
    return found


def _write(text: str, place: Place, mark: str, value: Any) -> str:
    if mark not in MARKS:
        raise ProfileError("There is no such mark.")
    if mark == "points":
        return set_value(text, f"{place.key}.curve", {"points": _read_points(value)})
    number = _read_number(value)
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


def _read_number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ProfileError("A mark needs a finite number.")
    return float(value)


def _read_points(value: Any) -> list[list[float]]:
    if not isinstance(value, list) or not 1 <= len(value) <= 16:
        raise ProfileError("A curve needs 1 to 16 points.")
    for point in value:
        if not isinstance(point, list) or len(point) != 2:
            raise ProfileError("A point of a curve needs two numbers, [x, y].")
    return [[round(_read_number(x), 2), round(_read_number(y), 2)] for x, y in value]
