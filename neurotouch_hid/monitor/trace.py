"""Writes one line of JSON for each slice, as a record of a run."""

import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.messages import Axis, Button, GamepadState, Step
from neurotouch_hid.monitor.sentence import direction_deg
from neurotouch_hid.monitor.text_output import TextOutput
from neurotouch_hid.partial_file import PartialFile


class TraceWriter:
    """A tap that writes ``path``; the file gets its name only when it is complete.

    Each line has ``t_us`` (end of the slice), ``gesture``, ``intensity_mm``, ``contacts_px``
    ([[x, y], ...]), ``direction_deg`` (0 right, 90 towards the user; null at rest),
    ``markers_tracked`` and ``pad`` (every axis -1..1 or 0..1, every button true or false).

    A disk that becomes full does not end the game: the trace is given up, and a sentence says so.

    Args:
        path: where the file will be.
        announce: is told sentences for the person.

    Raises:
        NeuroTouchError: the file cannot be made.
    """

    def __init__(
        self,
        path: Path,
        announce: Callable[[str], object] = str,  # says nothing
    ) -> None:
        self._path = path
        self._announce = announce
        try:
            self._partial = PartialFile(path)
        except OSError as error:
            raise NeuroTouchError.of_writing(path, error) from error
        self._file = io.TextIOWrapper(io.BufferedWriter(self._partial.file), encoding="utf-8")
        self._out = TextOutput(self._file, f"the trace {path}", announce)

    def __call__(self, step: Step) -> None:
        """Writes one line of JSON for a step."""
        self._out.write(json.dumps(_record(step), separators=(",", ":")) + "\n")

    def close(self) -> None:
        """Gives the finished file its name; what could not be written whole is removed."""
        self._out.flush()
        if self._out.has_failed:
            self._partial.discard()
            return
        try:
            self._partial.commit()
        except OSError as error:
            self._announce(f"Warning: the trace {self._path} is not kept: {error.strerror}.")


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
