"""Writes one line of JSON for each slice, as a record of a run."""

import json
from pathlib import Path
from typing import Any

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.messages import Axis, Button, GamepadState, Step
from neurotouch_hid.monitor.sentence import direction_deg


class TraceWriter:
    """A tap that writes ``path``; the file gets its name only when it is complete.

    Each line has ``t_us`` (end of the slice), ``gesture``, ``intensity_mm``, ``contacts_px``
    ([[x, y], ...]), ``direction_deg`` (0 right, 90 towards the user; null at rest),
    ``markers_tracked`` and ``pad`` (every axis -1..1 or 0..1, every button true or false).

    Raises:
        NeuroTouchError: the file cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        # A device or a pipe is written directly: a file must not replace it.
        is_file = path.is_file() or not path.exists()
        self._part = path.with_name(path.name + ".part") if is_file else path
        try:
            self._file = self._part.open("w", encoding="utf-8")
        except OSError as error:
            raise NeuroTouchError(
                f"The trace {path} cannot be written: {error.strerror}."
            ) from error

    def __call__(self, step: Step) -> None:
        """Writes one line of JSON for a step."""
        self._file.write(json.dumps(_record(step), separators=(",", ":")) + "\n")

    def close(self) -> None:
        """Gives the finished file its name."""
        self._file.close()
        self._part.replace(self._path)


def _record(step: Step) -> dict[str, Any]:
    gesture = step.gesture
    angle = direction_deg(gesture)
    return {
        "t_us": gesture.t_us,
        "gesture": gesture.kind.label,
        "intensity_mm": round(float(gesture.intensity_mm), 4),
        "contacts_px": [[round(float(x), 2), round(float(y), 2)] for x, y in gesture.contacts_px],
        "direction_deg": None if angle is None else round(angle, 2),
        "markers_tracked": int(step.markers.valid.sum()),
        "pad": _flat(step.pad),
    }


def _flat(pad: GamepadState) -> dict[str, float | bool]:
    axes = {str(axis): round(float(pad.axes.get(axis, 0.0)), 5) for axis in Axis}
    return {**axes, **{str(button): button in pad.buttons for button in Button}}
