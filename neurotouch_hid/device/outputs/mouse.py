"""The virtual mouse: five buttons, and steps of pointer and wheel made from their speeds."""

import math
from functools import lru_cache

from evdev import ecodes

from neurotouch_hid.device.outputs.spec import DeviceSpec, Steps, make_key
from neurotouch_hid.messages import GamepadState

NAME = "NeuroTouch Mouse"
IDS = (ecodes.BUS_VIRTUAL, 0x0000, 0x0002, 0x0001)
"""Bus, vendor, product, version: unassigned, as those of the keyboard."""

PHYS = "neurotouch/mouse0"

BUTTONS = {
    name: make_key(ecodes.ecodes[name])
    for name in ("BTN_LEFT", "BTN_RIGHT", "BTN_MIDDLE", "BTN_SIDE", "BTN_EXTRA")
}

MOTIONS = (
    ecodes.REL_X,
    ecodes.REL_Y,
    ecodes.REL_WHEEL,
    ecodes.REL_HWHEEL,  # nothing turns it yet, but programs know a mouse with both
    ecodes.REL_WHEEL_HI_RES,
    ecodes.REL_HWHEEL_HI_RES,
)

SPEC = DeviceSpec(NAME, IDS, PHYS, tuple(BUTTONS.values()), MOTIONS)

CLICK = 120
"""Steps of the fine wheel in one click, by definition of the kernel."""

_LONGEST_US = 50_000
"""Five slices of 10 ms. Over a longer gap the speed is unknown, and the pointer must not leap."""

_FASTEST_PX_S = 20_000.0
_FASTEST_CLICKS_S = 200.0
"""Four times the fastest speed of a binding, so that a bug elsewhere cannot throw the pointer."""


def encode_buttons(state: GamepadState) -> tuple[int, ...]:
    """Returns the report of a state: 1 for every button that is down, in the order of BUTTONS."""
    return _report(state.mouse_buttons)


@lru_cache(maxsize=1 << len(BUTTONS))
def _report(down: frozenset[str]) -> tuple[int, ...]:
    return tuple(int(name in down) for name in BUTTONS)


class PointerMotion:
    """Sums speeds over sensor time into whole steps, and keeps the remainder.

    A state describes the time since the state before it, as its gesture does.
    """

    def __init__(self) -> None:
        self._t_us: int | None = None
        self._left_over = dict.fromkeys("xyw", 0.0)
        self._since_click = 0

    def compute_steps(self, state: GamepadState) -> Steps:
        """Returns the steps from the state before to this one."""
        before_us, self._t_us = self._t_us, state.t_us
        if not (state.wheel or any(state.pointer)):
            return ()  # the remainder is less than a step
        dt_us = 0 if before_us is None else min(max(state.t_us - before_us, 0), _LONGEST_US)
        x, y = state.pointer
        fine = self._count("w", CLICK * _limit(state.wheel, _FASTEST_CLICKS_S), dt_us)
        steps = (
            (ecodes.REL_X, self._count("x", _limit(x, _FASTEST_PX_S), dt_us)),
            (ecodes.REL_Y, self._count("y", _limit(y, _FASTEST_PX_S), dt_us)),
            (ecodes.REL_WHEEL, self._click(fine)),
            (ecodes.REL_WHEEL_HI_RES, fine),
        )
        return tuple((code, n) for code, n in steps if n)

    def _count(self, name: str, per_s: float, dt_us: int) -> int:
        exact = self._left_over[name] + per_s * dt_us * 1e-6
        n_steps = round(exact)
        self._left_over[name] = exact - n_steps
        return n_steps

    def _click(self, fine: int) -> int:
        """Sends whole clicks, for programs that do not know the fine wheel."""
        self._since_click += fine
        n_clicks = int(self._since_click / CLICK)  # towards zero, the same up and down
        self._since_click -= n_clicks * CLICK
        return n_clicks


def _limit(value: float, most: float) -> float:
    return 0.0 if math.isnan(value) else min(max(value, -most), most)
