"""Reads the rig file beside a recording, which says how the camera saw the gel.

``NAME.rig.yaml`` beside ``NAME.aedat4``, every key optional::

    centre_px: [173.0, 130.0]   # the gel's centre in the picture as the user sees it
    px_per_mm: 2.5              # together with centre_px
    rotation_deg: 0.0           # turn of the marker lattice, clockwise; needs the two above
    mirrored: false             # the camera saw the gel mirrored; the source mirrors it back
"""

import difflib
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap
from ruamel.yaml.error import MarkedYAMLError, YAMLError

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX

KEYS = ("centre_px", "px_per_mm", "rotation_deg", "mirrored")
SCALE_LIMITS = (0.5, 10.0)  # px/mm: the gel 30 px wide, or only 26 mm of it in the picture


@dataclass(frozen=True, slots=True)
class RigFile:
    """The content of a rig file.

    Attributes:
        rig: the override, or None where the file leaves it to the resting frame.
        mirrored: events and frames have to be flipped left to right.
    """

    rig: Rig | None = None
    mirrored: bool = False


def rig_path(recording: Path | str) -> Path:
    """Returns the path of a recording's rig file: ``NAME.rig.yaml`` beside ``NAME.aedat4``."""
    return Path(recording).with_suffix(".rig.yaml")


def load_rig_file(path: Path | str) -> RigFile:
    """Returns the content of a rig file.

    Raises:
        RecordingError: it cannot be read, or a value is wrong (``file:line:column``).
    """
    path = Path(path)
    try:
        document = YAML(typ="rt").load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise RecordingError(f"'{path}' cannot be read: {error.strerror}.") from error
    except UnicodeDecodeError as error:
        raise RecordingError(f"'{path}' is not text in UTF-8.") from error
    except MarkedYAMLError as error:
        mark = error.problem_mark
        place = f"{path}:{mark.line + 1}:{mark.column + 1}" if mark else str(path)
        raise RecordingError(f"{place}: {error.problem or 'not valid YAML'}.") from error
    except (YAMLError, ValueError) as error:  # ValueError: a number such as 0o9
        raise RecordingError(f"'{path}' is not valid YAML.") from error
    if document is None:
        return RigFile()
    if not isinstance(document, CommentedMap):
        raise RecordingError(f"{path}:1:1: expected keys with values: {', '.join(KEYS)}.")
    return _Reader(path, document).read()


class _Reader:
    """Takes the values out of the document and knows the place of each."""

    def __init__(self, path: Path, document: CommentedMap) -> None:
        self._path, self._document = path, document

    def read(self) -> RigFile:
        for key in self._document:
            if key not in KEYS:
                close = difflib.get_close_matches(str(key), KEYS, n=1)
                meant = f"did you mean {close[0]}?" if close else f"known are {', '.join(KEYS)}"
                raise RecordingError(f"{self._place(key, 0)}: unknown key {key}; {meant}.")
        mirrored = self._document.get("mirrored", False)
        if not isinstance(mirrored, bool):
            raise self._error("mirrored", "true or false")
        centre, scale = self._centre(), self._number("px_per_mm", *SCALE_LIMITS)
        rotation_deg = self._number("rotation_deg", -360, 360)
        if centre is None and scale is None and rotation_deg is None:
            return RigFile(None, mirrored)
        if centre is None or scale is None:
            missing = "centre_px" if centre is None else "px_per_mm"
            given = next(key for key in self._document if key != "mirrored")
            raise RecordingError(
                f"{self._place(given, 0)}: {given} needs {missing} beside it.",
                hint="Give both, or leave the rig to be found from the resting frame.",
            )
        return RigFile(Rig(centre, scale, math.radians(rotation_deg or 0.0), mirrored), mirrored)

    def _centre(self) -> tuple[float, float] | None:
        if "centre_px" not in self._document:
            return None
        value = self._document["centre_px"]
        expected = f"[x, y] within {SENSOR_WIDTH_PX}×{SENSOR_HEIGHT_PX} pixels"
        if not isinstance(value, list) or len(value) != 2:
            raise self._error("centre_px", expected)
        for number, limit in zip(value, (SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX), strict=True):
            if not _is_number(number) or not 0 <= number < limit:
                raise self._error("centre_px", expected)
        return float(value[0]), float(value[1])

    def _number(self, key: str, low: float, high: float) -> float | None:
        if key not in self._document:
            return None
        value = self._document[key]
        if not _is_number(value) or not low <= value <= high:
            raise self._error(key, f"a number from {low:g} to {high:g}")
        return float(value)

    def _error(self, key: str, expected: str) -> RecordingError:
        value = self._document[key]
        found = list(value) if isinstance(value, list) else value
        return RecordingError(
            f"{self._place(key, 2)}: {key}: expected {expected}, found {found!r}."
        )

    def _place(self, key: object, of: int) -> str:
        """Returns ``file:line:column`` of a key (``of`` 0) or of its value (``of`` 2)."""
        line, column = self._document.lc.data[key][of : of + 2]
        return f"{self._path}:{line + 1}:{column + 1}"


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
