"""Care for a mouse moved by the gel: still while it clicks, and clicks by resting."""

import math
from typing import Final

from neurotouch_hid.profile.decision_log import DecisionLog
from neurotouch_hid.profile.engine.output import Outputs
from neurotouch_hid.profile.schema.keyboard_keys import MOUSE_BUTTONS
from neurotouch_hid.profile.schema.targets import MouseMotionTarget

FREEZE_PX: Final = 12.0
"""How far one must push while clicking before the pointer follows: a drag, not a tremor."""

ARM_PX: Final = 10.0
"""A dwell click needs a real movement before it, so that nothing is clicked twice."""

LOCK_US: Final = 250_000
"""A dwell tells that it has begun once the pointer has rested this long; moving on ends it."""

CLICK_US: Final = 50_000
_DWELL: Final = "dwell -> mouse left"


class PointerCare:
    """Freezes the pointer while a button is down; clicks where it rests, in two audible steps."""

    def __init__(self, target: MouseMotionTarget, log: DecisionLog) -> None:
        self._log = log
        self._freezes = target.freeze_on_click
        self._dwell_us = None if target.dwell_ms is None else 1000 * target.dwell_ms
        self._pressed_px = 0.0
        self._moved_px = 0.0
        self._rest_us: int | None = None
        self._locked = False
        self._click_us: int | None = None
        self._t_us: int | None = None

    def tend(self, outputs: Outputs, t_us: int) -> None:
        """Changes the pointer and the left button of the outputs where care is due."""
        step_s = 0.0 if self._t_us is None else min(max(t_us - self._t_us, 0), 50_000) * 1e-6
        self._t_us = t_us
        way_px = math.hypot(*outputs.pointer) * step_s
        if self._dwell_us is not None:
            self._dwell(outputs, t_us, way_px, self._dwell_us)
        if self._freezes:
            self._pressed_px = self._pressed_px + way_px if outputs.mouse_buttons else 0.0
            if outputs.mouse_buttons and self._pressed_px < FREEZE_PX:
                outputs.pointer = (0.0, 0.0)

    def _dwell(self, outputs: Outputs, t_us: int, way_px: float, dwell_us: int) -> None:
        if any(outputs.pointer):
            self._moved_px += way_px
            self._rest_us, self._locked = None, False
        elif self._rest_us is None:
            self._rest_us = t_us
        elif self._moved_px >= ARM_PX:
            rested_us = t_us - self._rest_us
            if not self._locked and rested_us >= min(LOCK_US, dwell_us):
                self._locked = True
                self._log.note("step", _DWELL, "1 of 2")
            if rested_us >= dwell_us:
                self._click_us, self._moved_px = t_us, 0.0
                self._log.note("pressed", _DWELL)
        if self._click_us is not None and t_us - self._click_us < CLICK_US:
            outputs.mouse_buttons.add(MOUSE_BUTTONS["left"])
