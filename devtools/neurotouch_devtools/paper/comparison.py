"""Says what differs between committed results and those that have just been made.

On one machine nothing should differ at all. Other processors and libraries round the last digit of
a number in another way, so single events appear or not, and a few slices at the edges of gestures
get another type. The tolerances allow for that and for no more.
"""

import re
from collections.abc import Mapping, Sequence
from typing import Final

from neurotouch_devtools.paper.results import Result

SHARE: Final = 0.005
"""Of a share: half a point, which is the least that the documents call a difference."""
SLICES: Final = 2
"""Beyond that, so many slices, gestures or false gestures may be decided otherwise."""
LENGTH_MM: Final = 0.05
TIME_MS: Final = 20.0
"""Two slices."""
POINTS: Final = 3.0
"""Of a picture: 1 mm where a page shows it in its own size."""

_NUMBER: Final = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")
_NAME: Final = re.compile(r"\b[a-z][0-9a-f]{10}\b")
"""matplotlib names clips and marks by a digest of their content."""
_LETTERS: Final = re.compile(r'<(?:use|path)[^>]*"#?DejaVuSans[^>]*/>')
"""Drawn letters: the comment before them has the text."""


def compare_results(committed: Sequence[Result], made: Sequence[Result]) -> list[str]:
    """Returns a sentence for each figure that differs by more than its tolerance."""
    before = {row[:3]: row for row in committed}
    now = {row[:3]: row for row in made}
    differences = [f"{_name(key)} is no longer made." for key in before if key not in now]
    differences += [f"{_name(key)} is new." for key in now if key not in before]
    for key, old in before.items():
        new = now.get(key)
        if new is None or old.value == new.value:
            continue
        if old.value is None or new.value is None:
            differences.append(f"{_name(key)}: {_show(old)} became {_show(new)}.")
        elif abs(new.value - old.value) > (limit := find_tolerance(old)):
            differences.append(
                f"{_name(key)}: {_show(old)} became {_show(new)}; "
                f"{_show(old._replace(value=limit))} is allowed."
            )
    return differences


def find_tolerance(row: Result) -> float:
    """Returns by how much a figure may differ, in its own unit (of a share, in 1)."""
    of = max(row.of, 1)
    match row.unit:
        case "%":
            return SHARE + SLICES / of
        case "mm":
            return LENGTH_MM + SLICES / of
        case "ms":
            return TIME_MS
        case "/10 min":
            return SLICES * 600.0 / of
        case _:
            return max(2.0, 0.01 * abs(row.value or 0.0))


def compare_pictures(committed: Mapping[str, str], made: Mapping[str, str]) -> list[str]:
    """Returns a sentence for each picture that looks different.

    Args:
        committed: the SVG of each picture, by name.
        made: those that have just been drawn.
    """
    differences = [f"Picture {name} is no longer made." for name in committed if name not in made]
    differences += [f"Picture {name} is new." for name in made if name not in committed]
    for name, old in committed.items():
        if name not in made or made[name] == old:
            continue
        before, now = _strip(old), _strip(made[name])
        if _NUMBER.sub("0", before) != _NUMBER.sub("0", now):
            differences.append(f"Picture {name} is drawn otherwise.")
            continue
        pairs = zip(_NUMBER.findall(before), _NUMBER.findall(now), strict=True)
        most = max((abs(float(a) - float(b)) for a, b in pairs), default=0.0)
        if most > POINTS:
            differences.append(f"Picture {name}: something moved by {most:.1f} points.")
    return differences


def _strip(svg: str) -> str:
    return _LETTERS.sub("", _NAME.sub("name", svg))


def _name(key: Sequence[object]) -> str:
    return " ".join(str(part) for part in key)


def _show(row: Result) -> str:
    if row.value is None:
        return "undefined"
    if row.unit == "%":
        return f"{100.0 * row.value:.2f} %"
    return f"{row.value:.4g} {row.unit}".rstrip()
