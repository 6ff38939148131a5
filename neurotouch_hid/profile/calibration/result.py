"""Works out noise, ranges and weak sides, and writes them to the user's file."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Final

from neurotouch_hid.profile.editing.edit_values import reset_value, set_value, take_back
from neurotouch_hid.profile.editing.profile_text import ProfileText
from neurotouch_hid.profile.editing.yaml_values import format_value
from neurotouch_hid.profile.schema.movements import MOVEMENTS
from neurotouch_hid.profile.schema.timing import FilterName
from neurotouch_hid.profile.schema.user import MovementRange, Ranges, UserSettings

LEAST_PEAK_MM: Final = 2.5
LEAST_PEAKS: Final = 2
FULL_SHARE: Final = 0.8
"""Full output needs 0.8 of a comfortable movement, never the largest one."""

LEAST_REST_MM: Final = 0.6
MOST_REST_MM: Final = 3.0
LEAST_ROOM_MM: Final = 1.0
WEAK_SHARE: Final = 0.5
_CALIBRATED: Final = ("unused", "filter", "tremor_hz")
_DATE: Final = re.compile(r"^# Calibrated \d{4}-\d{2}-\d{2}\.", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class WeakSide:
    """A movement much smaller than the one the other way.

    Attributes:
        weak: the smaller one.
        strong: the larger one.
        share: how far the smaller goes, as a share of the larger; 0 if it is not used.
    """

    weak: str
    strong: str
    share: float


def measure_rest(resting_mm: Sequence[float]) -> float:
    """Returns the noise limit: three deviations of the rest, 0.6 mm at least.

    Args:
        resting_mm: the intensity while nothing was done, in mm; may be empty.
    """
    if not resting_mm:
        return 1.0
    middle = median(resting_mm)
    deviation = math.sqrt(sum((mm - middle) ** 2 for mm in resting_mm) / len(resting_mm))
    return round(min(max(LEAST_REST_MM, 3.0 * deviation), MOST_REST_MM), 1)


def measure_range(peaks_mm: Sequence[float], rest_mm: float) -> MovementRange | None:
    """Returns the comfortable range of a movement; None if it is not used.

    Args:
        peaks_mm: how far each repetition went; those below 2.5 mm do not count.
        rest_mm: up to where it is noise.
    """
    counted = [peak for peak in peaks_mm if peak >= LEAST_PEAK_MM]
    if len(counted) < LEAST_PEAKS:
        return None
    full = min(max(FULL_SHARE * median(counted), rest_mm + LEAST_ROOM_MM), 18.0)
    return MovementRange(rest=rest_mm, full=round(full, 1))


def find_weak_sides(ranges: Mapping[str, MovementRange | None]) -> list[WeakSide]:
    """Returns the measured movements whose partner, also measured, goes more than twice as far."""
    found = []
    for name, range_ in ranges.items():
        strong = MOVEMENTS[name].partner
        theirs = ranges.get(strong)
        if theirs is None:
            continue
        share = 0.0 if range_ is None else range_.full / theirs.full
        if share < WEAK_SHARE:
            found.append(WeakSide(name, strong, share))
    return found


def write_ranges(
    text: ProfileText,
    ranges: Mapping[str, MovementRange | None],
    date: str,
    tremor_filter: FilterName | None = None,
    tremor_hz: float | None = None,
) -> ProfileText:
    """Returns the user's file with these ranges.

    A movement that is not used has none, and is named so.

    Args:
        text: the file.
        ranges: the measured movements only; all others stay.
        date: today, as YYYY-MM-DD.
        tremor_filter: the filter to be set, or None to leave that as it is.
        tremor_hz: the frequency to be taken out, or None to leave that as it is.
    """
    measured = {
        name: {"rest": range_.rest, "full": range_.full}
        for name, range_ in ranges.items()
        if range_ is not None
    }
    before: list[str] = text.document.get("unused", [])
    if "range" not in text.document:
        lines = [f"  {name}: {format_value(values)}" for name, values in measured.items()]
        if lines:
            text = text.insert_lines(len(text.text), ["", "range:", *lines])
    else:
        for name in Ranges.model_fields:
            if name in measured:
                text = set_value(text, f"range.{name}", measured[name], UserSettings)
            elif name in ranges and text.find(("range", name)) is not None:
                text = reset_value(text, f"range.{name}", UserSettings)
    text = _write_unused(text, before, ranges)
    if tremor_filter is not None:
        text = set_value(text, "filter", tremor_filter, UserSettings)
    if tremor_hz is not None:
        text = set_value(text, "tremor_hz", round(tremor_hz, 1), UserSettings)
    return _put_date(text, date)


def undo_ranges(text: ProfileText, before: ProfileText, after: ProfileText) -> ProfileText:
    """Returns the user's file as it was before a calibration, without touching anything else.

    Args:
        text: the file now.
        before: the file when the calibration began.
        after: the file when it was saved. What was changed again since then stays.
    """
    names = [*(f"range.{each}" for each in Ranges.model_fields), *_CALIBRATED]
    text = take_back(text, before, after, names, UserSettings)
    saved, first = _DATE.search(after.text), _DATE.search(before.text)
    if saved is None:
        return text
    return text.rewrite(text.text.replace(f"{saved[0]}\n", f"{first[0]}\n" if first else "", 1))


def _write_unused(
    text: ProfileText, before: list[str], ranges: Mapping[str, MovementRange | None]
) -> ProfileText:
    lost = {name: ranges[name] is None if name in ranges else name in before for name in MOVEMENTS}
    unused = [name for name, is_lost in lost.items() if is_lost]
    if unused == before:
        return text
    if unused:
        return set_value(text, "unused", unused, UserSettings)
    return reset_value(text, "unused", UserSettings)


def _put_date(text: ProfileText, date: str) -> ProfileText:
    line = f"# Calibrated {date}."
    if _DATE.search(text.text):
        return text.rewrite(_DATE.sub(line, text.text, count=1))
    return text.rewrite(
        re.sub(r"^range:", f"{line}\nrange:", text.text, count=1, flags=re.MULTILINE)
    )
