"""Reads the rig file beside a recording, which says how the camera saw the gel.

``NAME.rig.yaml`` beside ``NAME.aedat4``, every key optional::

    centre_px: [173.0, 130.0]   # the gel's centre in the picture as the user sees it
    px_per_mm: 2.5              # together with centre_px
    rotation_deg: 0.0           # turn of the marker lattice, clockwise; needs the two above
    mirrored: false             # the camera saw the gel mirrored; the source mirrors it back
    strobe: {hz: 20, dark_us: 1500}  # the LED ring went off at regular times

Of a sensor of another size than 346 x 260 px, place and scale are in that sensor's own picture.
"""

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.files.faults import SHOWN_COLUMNS, Mark, suggest
from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_text
from neurotouch_hid.files.yaml_document import Node, parse_document
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.printable import make_printable
from neurotouch_hid.source.strobe.config import StrobeConfig

KEYS = ("centre_px", "px_per_mm", "rotation_deg", "mirrored", "strobe")
STROBE_LIMITS = {"hz": (5.0, 50.0), "dark_us": (500.0, 5_000.0)}
SCALE_LIMITS = (0.5, 10.0)  # px/mm: the gel 30 px wide, or only 26 mm of it in the picture
_CONTENT = re.compile(r"^\s*[^\s#]", re.MULTILINE)
"""A line that is more than a comment."""


@dataclass(frozen=True, slots=True)
class RigFile:
    """The content of a rig file.

    Attributes:
        rig: the override, or None where the file leaves it to the resting frame.
        mirrored: events and frames have to be flipped left to right.
        strobe: how the LED ring was switched; None if it stayed on.
    """

    rig: Rig | None = None
    mirrored: bool = False
    strobe: StrobeConfig | None = None


def rig_path(recording: Path | str) -> Path:
    """Returns the path of a recording's rig file: ``NAME.rig.yaml`` beside ``NAME.aedat4``."""
    return Path(recording).with_suffix(".rig.yaml")


def load_rig_file(
    path: Path | str, size_px: tuple[int, int] = (SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX)
) -> RigFile:
    """Returns the content of a rig file.

    Args:
        path: the file.
        size_px: width and height of the sensor's picture.

    Raises:
        RecordingError: it cannot be read, or a value is wrong (``file:line:column``).
    """
    path = Path(path)
    try:
        text = read_text(path, MAX_SETTINGS_BYTES)
    except OSError as error:
        raise RecordingError(f"'{path}' cannot be read: {error.strerror}.") from error
    if not _CONTENT.search(text):
        return RigFile()
    document, faults = parse_document(text)
    if faults:
        fault = min(faults)
        raise RecordingError(
            f"{_format_place(path, fault.mark)}: {fault.sentence}.", hint=fault.hint or None
        )
    if document is None or not isinstance(document.value, dict):
        raise RecordingError(f"{path}:1:1: expected keys with values: {', '.join(KEYS)}.")
    return _Reader(path, document, size_px).read()


def describe_strobe(strobe: StrobeConfig) -> str:
    """Returns the line of a rig file that says how the LED ring was switched."""
    return f"strobe: {{hz: {strobe.hz:g}, dark_us: {strobe.dark_us}}}"


class _Reader:
    """Takes the values out of the document and knows the place of each."""

    def __init__(self, path: Path, document: Node, size_px: tuple[int, int]) -> None:
        self._path, self._document, self._size_px = path, document, size_px
        self._values: dict[str, Any] = document.value

    def read(self) -> RigFile:
        for key, mark in self._document.keys.items():
            if key not in KEYS:
                meant = suggest(key, KEYS) or f"known are {', '.join(KEYS)}."
                place = _format_place(self._path, mark)
                name = make_printable(key[:SHOWN_COLUMNS])
                raise RecordingError(f"{place}: unknown key {name}; {meant}")
        mirrored = self._values.get("mirrored", False)
        if not isinstance(mirrored, bool):
            raise self._error("mirrored", "true or false")
        least, most = SCALE_LIMITS
        most *= max(1.0, self._size_px[0] / SENSOR_WIDTH_PX)
        centre, scale = self._centre(), self._number("px_per_mm", least, most)
        rotation_deg = self._number("rotation_deg", -360, 360)
        strobe = self._strobe()
        if centre is None and scale is None and rotation_deg is None:
            return RigFile(None, mirrored, strobe)
        if centre is None or scale is None:
            missing = "centre_px" if centre is None else "px_per_mm"
            given = next(key for key in self._values if key not in ("mirrored", "strobe"))
            place = _format_place(self._path, self._document.keys[given])
            raise RecordingError(
                f"{place}: {given} needs {missing} beside it.",
                hint="Give both, or leave the rig to be found from the resting frame.",
            )
        rig = Rig(centre, scale, math.radians(rotation_deg or 0.0), mirrored)
        return RigFile(rig, mirrored, strobe)

    def _strobe(self) -> StrobeConfig | None:
        if "strobe" not in self._values:
            return None
        value = self._values["strobe"]
        if not isinstance(value, dict) or set(value) != set(STROBE_LIMITS):
            raise self._error("strobe", "{hz: 20, dark_us: 1500}, or other numbers")
        for key, (least, most) in STROBE_LIMITS.items():
            if not _is_number(value[key]) or not least <= value[key] <= most:
                raise self._error("strobe", f"{key} from {least:g} to {most:g}")
        return StrobeConfig(float(value["hz"]), int(value["dark_us"]))

    def _centre(self) -> tuple[float, float] | None:
        if "centre_px" not in self._values:
            return None
        value = self._values["centre_px"]
        expected = f"[x, y] within {self._size_px[0]}×{self._size_px[1]} pixels"
        if not isinstance(value, list) or len(value) != 2:
            raise self._error("centre_px", expected)
        for number, limit in zip(value, self._size_px, strict=True):
            if not _is_number(number) or not 0 <= number < limit:
                raise self._error("centre_px", expected)
        return float(value[0]), float(value[1])

    def _number(self, key: str, low: float, high: float) -> float | None:
        if key not in self._values:
            return None
        value = self._values[key]
        if not _is_number(value) or not low <= value <= high:
            raise self._error(key, f"a number from {low:g} to {high:g}")
        return float(value)

    def _error(self, key: str, expected: str) -> RecordingError:
        place = _format_place(self._path, self._document.children[key].mark)
        found = make_printable(repr(self._values[key]))
        if len(found) > SHOWN_COLUMNS:
            found = f"{found[:SHOWN_COLUMNS]}…"
        return RecordingError(f"{place}: {key}: expected {expected}, found {found}.")


def _format_place(path: Path, mark: Mark) -> str:
    return f"{path}:{mark.line + 1}:{mark.column + 1}"


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
