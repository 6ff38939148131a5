"""A person's own range of each movement, converted to that of the reference hand."""

import math
from collections.abc import Callable

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile.engine.regions import Vector
from neurotouch_hid.profile.schema.profile import DEFAULT_FULL_MM, DEFAULT_REST_MM
from neurotouch_hid.profile.schema.user import MovementRange, Ranges

Convert = Callable[[GestureKind, float, Vector | None], float]


def make_conversion(ranges: Ranges) -> Convert | None:
    """Returns a function from (kind, intensity in mm, way of a push) to mm of the reference hand.

    None if no range is set.
    What the person's ``rest`` is becomes 1 mm, what is ``full`` becomes the default full of that
    gesture, straight in between and beyond. The range of a diagonal push is blended from the two
    beside it by angle.
    """
    if not ranges.model_fields_set:
        return None
    usual = MovementRange(rest=DEFAULT_REST_MM, full=DEFAULT_FULL_MM[GestureKind.PUSH])
    left, right, up, down = (
        ranges.push_left or usual,
        ranges.push_right or usual,
        ranges.push_up or usual,
        ranges.push_down or usual,
    )
    plain = {
        GestureKind[name.upper()]: getattr(ranges, name)
        for name in ("pinch", "zoom", "twist_cw", "twist_ccw")
        if getattr(ranges, name) is not None
    }

    def convert(kind: GestureKind, mm: float, way: Vector | None) -> float:
        if kind == GestureKind.PUSH and way is not None:
            sideways = right if way[0] >= 0.0 else left
            along = down if way[1] >= 0.0 else up
            share = math.atan2(abs(way[1]), abs(way[0])) / (0.5 * math.pi)
            rest = sideways.rest + share * (along.rest - sideways.rest)
            full = sideways.full + share * (along.full - sideways.full)
        elif kind in plain:
            rest, full = plain[kind].rest, plain[kind].full
        else:
            return mm
        if mm <= rest:
            return DEFAULT_REST_MM * mm / rest if rest > 0.0 else 0.0
        extent_mm = DEFAULT_FULL_MM[kind] - DEFAULT_REST_MM
        return DEFAULT_REST_MM + extent_mm * (mm - rest) / (full - rest)

    return convert
