"""Shows gel, gesture and pad in a terminal: a live picture, or plain lines."""

import shutil
import threading
from collections.abc import Callable, Sequence

import numpy as np

from neurotouch_hid.gel_sentences import explain_gel
from neurotouch_hid.geometry import fit_rig
from neurotouch_hid.messages import Axis, Button, GamepadState, GelProblem, GestureKind, Step
from neurotouch_hid.monitor.sentence import describe_gesture, describe_outputs
from neurotouch_hid.monitor.text_output import Writable
from neurotouch_hid.printable import make_printable
from neurotouch_hid.profile import MappingDecision

PICTURE_HZ = 12.0
"""Redraws per second: smooth to the eye, a few percent of a core."""
LINE_INTERVAL_S = 0.3
"""Shortest time between two plain lines, so that a screen reader can follow."""
_ARROWS = "→↘↓↙←↖↑↗"
_BAR = 24
READINGS = 43
"""Columns beside the gel, for all bars and most sentences; a narrower terminal has no picture."""
_BUTTONS = tuple(Button)
_HALF = (len(_BUTTONS) + 1) // 2  # two rows, so that 80 columns are enough


class LinesMonitor:
    """A tap that prints a line whenever the gesture, the pressed controls or the gel change.

    Args:
        out: the lines are written there.
        decisions: returns the latest decisions of the mapping, oldest first; a line explains each
            gesture that had no effect.
    """

    def __init__(
        self, out: Writable, decisions: Callable[[], Sequence[MappingDecision]] = tuple
    ) -> None:
        self._out = out
        self._decisions = decisions
        self._said = ""
        self._gel = True, GelProblem.NONE
        self._peak_mm = 0.0
        self._due_us = self._told_us = -(1 << 62)
        self._begun_us: int | None = None

    def __call__(self, step: Step) -> None:
        """Prints the changes in ``step``, if there are any."""
        if self._begun_us is None:  # the clock of a camera does not begin at 0
            self._begun_us = step.gesture.t_us
        for decision in self._decisions():
            if decision.t_us > self._told_us and decision.is_refusal:
                self._write(step, str(decision))
        self._told_us = step.gesture.t_us
        if step.gel.problem is GelProblem.WAITING:
            return
        self._write_gel(step)
        self._peak_mm = max(self._peak_mm, step.gesture.intensity_mm)
        if step.gesture.t_us < self._due_us:
            return
        pressed = ", ".join(str(control) for control in sorted(_pressed(step)))
        said = f"{step.gesture.kind.label} {pressed} {step.gel.is_found}"
        if said != self._said:
            self._said = said
            self._due_us = step.gesture.t_us + int(LINE_INTERVAL_S * 1e6)
            gesture = describe_gesture(step.gesture) if step.gel.is_found else "no gel"
            if step.gesture.kind is GestureKind.NONE:
                gesture += f" (peak {self._peak_mm:.1f} mm)" if self._peak_mm else ""
                self._peak_mm = 0.0
            self._write(step, f"{gesture}; pad {describe_outputs(step.pad) or 'neutral'}")

    def _write_gel(self, step: Step) -> None:
        gel = step.gel.is_found, step.gel.problem
        if gel == self._gel:
            return
        self._gel = gel
        sentence = explain_gel(step.gel)
        self._write(step, f"gel {sentence.text}. {sentence.fix}".rstrip())

    def _write(self, step: Step, words: str) -> None:
        seconds = (step.gesture.t_us - (self._begun_us or 0)) / 1e6
        self._out.write(f"{seconds:8.2f} s  {words}\n")
        self._out.flush()

    def close(self) -> None:
        """Does nothing: there is nothing to restore."""


class PictureMonitor:
    """A tap that keeps the newest step; a separate thread draws it, so the pipeline never waits.

    Args:
        out: a terminal that understands ANSI escapes.
        title: first line of the picture.
    """

    def __init__(self, out: Writable, title: str) -> None:
        self._out = out
        self._title = title
        self._step: Step | None = None
        self._begun_us: int | None = None
        self._height = 0
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._draw_on, name="monitor", daemon=True)
        self._out.write("\x1b[?25l")
        self._thread.start()

    def __call__(self, step: Step) -> None:
        """Passes ``step`` to the drawing thread."""
        if self._begun_us is None:  # the clock of a camera does not begin at 0
            self._begun_us = step.gesture.t_us
        self._step = step

    def leave(self) -> None:
        """Leaves the last picture, because the process stops for a while."""
        self._height = 0
        self._out.write("\x1b[?25h")
        self._out.flush()

    def close(self) -> None:
        """Leaves the last picture and shows the cursor again."""
        self._done.set()
        self._thread.join(timeout=1.0)
        self._out.write("\x1b[?25h")
        self._out.flush()

    def _draw_on(self) -> None:
        while not self._done.wait(1 / PICTURE_HZ):
            self._draw()
        self._draw()

    def _draw(self) -> None:
        if self._step is None:
            return
        columns, rows = shutil.get_terminal_size()  # a longer line or picture would scroll
        drawn = draw_step(self._step, self._title, self._begun_us or 0, columns)
        lines = [make_printable(line[:columns]) for line in drawn[: rows - 1]]
        up = f"\x1b[{self._height}A" if self._height else ""
        self._height = len(lines)
        self._out.write(up + "".join(f"\r{line}\x1b[K\n" for line in lines))
        self._out.flush()


def draw_step(step: Step, title: str, begun_us: int = 0, columns: int = 80) -> list[str]:
    """Returns one step as lines of text, 15 rows of gel with the readings beside it.

    Args:
        step: what to show.
        title: the first words.
        begun_us: the time of the first step; seconds are counted from there.
        columns: width of the terminal; where both do not fit, the gel is left out.
    """
    gesture, pad = step.gesture, step.pad
    tracked = int(step.markers.valid.sum())
    right = [
        f"gesture    {describe_gesture(gesture)}",
        f"intensity  {gesture.intensity_mm:4.1f} mm {_bar(gesture.intensity_mm / 18)}",
        f"markers    {tracked} of {step.markers.gel.n_markers} tracked",
        f"gel        {explain_gel(step.gel).text}",
        *(f"{axis:<14} {_axis(axis, pad.axes.get(axis, 0.0))}" for axis in Axis),
        "",
        f"buttons    {_list_buttons(pad, _BUTTONS[:_HALF])}",
        f"           {_list_buttons(pad, _BUTTONS[_HALF:])}",
    ]
    gel = _gel(step)
    right += [""] * (len(gel) - len(right))
    head = f"NeuroTouch  {title}  {(gesture.t_us - begun_us) / 1e6:.2f} s"
    if len(gel[0]) + READINGS > columns:
        return [head, "", *right]
    return [head, "", *(f"{g}   {r}" for g, r in zip(gel, right, strict=True))]


def _gel(step: Step) -> list[str]:
    made = step.markers.gel
    columns = np.rint(made.points_mm / made.pitch_mm).astype(int)
    size = int(np.abs(columns).max())
    grid = [[" "] * (4 * size + 1) for _ in range(2 * size + 1)]
    moved = step.markers.position_px - step.markers.rest_px
    for (cx, cy), (dx, dy), valid in zip(columns, moved, step.markers.valid, strict=True):
        far = bool(np.hypot(dx, dy) > 2.0)
        sign = _ARROWS[round(np.degrees(np.arctan2(dy, dx)) / 45) % 8] if far else "·"
        grid[cy + size][2 * (cx + size)] = sign if valid else "?"
    if step.gesture.kind is not GestureKind.NONE and np.isfinite(step.markers.rest_px).any():
        rig = fit_rig(step.markers.rest_px, made)
        for x, y in np.rint(rig.to_mm(step.gesture.contacts_px) / made.pitch_mm).astype(int):
            if abs(x) <= size and abs(y) <= size:
                grid[y + size][2 * (x + size)] = "●"
    return ["".join(row) for row in grid]


def _list_buttons(pad: GamepadState, buttons: Sequence[Button]) -> str:
    return "".join(f"[{b.upper()}]" if b in pad.buttons else f" {b} " for b in buttons)


def _bar(share: float) -> str:
    filled = round(min(max(share, 0.0), 1.0) * _BAR)
    return "█" * filled + "░" * (_BAR - filled)


def _axis(axis: Axis, value: float) -> str:
    if axis in (Axis.LEFT_TRIGGER, Axis.RIGHT_TRIGGER):
        return _bar(value)
    line = ["─"] * (_BAR + 1)
    line[_BAR // 2] = "┼"
    line[round((min(max(value, -1.0), 1.0) + 1) / 2 * _BAR)] = "●" if value else "┼"
    return "".join(line)


def _pressed(step: Step) -> set[str]:
    axes = {str(axis) for axis, value in step.pad.axes.items() if value}
    return axes | {str(button) for button in step.pad.buttons}
