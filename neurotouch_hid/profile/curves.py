"""How an intensity in mm becomes a value of 0..1: range, then dead zone, then curve.

1 |         ____    range     where the movement begins and ends, in mm
  |       ,'        dead zone what stays exactly 0; the rest is stretched, so nothing jumps
  |     ,'          curve     linear, expo or power; all go through (0, 0) and (1, 1) and rise
0 |____/
    rest   full  mm
"""

from collections.abc import Callable

from neurotouch_hid.profile.targets import Curve, Expo, Power

Response = Callable[[float], float]


def make_response(range_mm: tuple[float, float], deadzone: float, curve: Curve) -> Response:
    """A function from an intensity in mm (finite) to a value of 0..1, rising, end to end.

    Args:
        range_mm: (rest, full); 0 up to ``rest``, 1 from ``full`` on.
        deadzone: share of that range that stays 0.
        curve: the form in between.
    """
    rest_mm, full_mm = range_mm
    begin_mm = rest_mm + deadzone * (full_mm - rest_mm)
    extent_mm = full_mm - begin_mm
    bend = _make_bend(curve)

    def respond(intensity_mm: float) -> float:
        if intensity_mm <= begin_mm:
            return 0.0
        if intensity_mm >= full_mm:
            return 1.0
        return bend((intensity_mm - begin_mm) / extent_mm)

    return respond


def _make_bend(curve: Curve) -> Response:
    match curve:
        case Expo(expo=expo):
            return lambda x: x * (1.0 - expo + expo * x * x)
        case Power(power=power):
            return lambda x: x**power
        case _:
            return lambda x: x
