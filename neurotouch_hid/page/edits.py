"""What the page may change: marks and curves of the bindings of the profile that holds."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.page.profile_view import Place, is_editable, list_places
from neurotouch_hid.profile import Profile, check_profile
from neurotouch_hid.profile.editing import (
    EditedFile,
    compare,
    set_value,
    take_profile,
)

MARKS: Final = ("on_mm", "off_mm", "rest", "full", "expo", "power", "points")


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
        """
        paper = self._take(path)
        place = _find_place(path, key)
        text = _write(paper.text, place, mark, value)
        if text == paper.text:
            return f"{paper.name} says so already."
        paper.save(text)
        n_changed = len([line for line in compare(paper.text, text) if line[0] == "added"])
        what = f"{key} {mark.removesuffix('_mm')}"
        return f"Saved {what} in {paper.name}: {n_changed} line{'s' if n_changed > 1 else ''}."

    def undo(self, path: Path) -> str:
        """Takes back the last change.

        Raises:
            ProfileError: there is none.
        """
        paper = self._take(path)
        version = paper.store.undo()
        return f"{paper.name} is as in version {version.number} again."

    def _take(self, path: Path) -> EditedFile:
        if not is_editable(path):
            raise ProfileError(
                "this profile lies outside your profile folder, so it is not changed from here",
                hint="Change it with an editor, or import it.",
            )
        return take_profile(path.stem, self._stamp)


def _find_place(path: Path, key: str) -> Place:
    """The binding of that name, from the file alone: nothing else is ever touched."""
    written = check_profile(path).written
    places = list_places(written) if isinstance(written, Profile) else []
    found = next((place for place in places if place.key == key), None)
    if found is None:
        raise ProfileError("there is no such binding in the profile that holds")
    return found


def _write(text: str, place: Place, mark: str, value: Any) -> str:
    if mark not in MARKS:
        raise ProfileError("there is no such mark")
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
        raise ProfileError("a mark needs a finite number")
    return float(value)


def _read_points(value: Any) -> list[list[float]]:
    if not isinstance(value, list) or not 1 <= len(value) <= 16:
        raise ProfileError("a curve needs 1 to 16 points")
    for point in value:
        if not isinstance(point, list) or len(point) != 2:
            raise ProfileError("a point of a curve needs two numbers, [x, y]")
    return [[round(_read_number(x), 2), round(_read_number(y), 2)] for x, y in value]
