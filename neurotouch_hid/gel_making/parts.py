"""The parts that a printer makes, each in the pose in which it is printed."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from neurotouch_hid.gel_making.housing import (
    make_body,
    make_camera_plate,
    make_clamp,
    make_led_ring,
)
from neurotouch_hid.gel_making.plan import Plan
from neurotouch_hid.gel_making.skin import make_mould, make_skin, make_two_colours

if TYPE_CHECKING:
    from manifold3d import Manifold

_FIRM = "any firm filament, dull black inside"
_HARD = "any firm filament, layers of 0.1 mm"


@dataclass(frozen=True, slots=True)
class Part:
    """A part to be printed.

    Attributes:
        file: the name of its STL file, without its ending.
        what: what it is.
        material: of what, and how fine.
        support: where it needs support; empty if it needs none.
        solid: the part in mm, its flat side on z = 0.
    """

    file: str
    what: str
    material: str
    support: str
    solid: "Manifold"


def make_parts(plan: Plan) -> list[Part]:
    """Returns the printed parts of a gel; of a first evening there are none.

    Raises:
        NeuroTouchError: the library for solids is missing.
    """
    if plan.way == "evening":
        return []
    parts = _make_dome(plan) if plan.way == "printed" else _make_mould(plan)
    return [
        *parts,
        Part("clamp", "presses the skin on the body", _FIRM, "", make_clamp(plan)),
        Part("ring", "carries 12 LEDs, which look up", _FIRM, "", make_led_ring(plan)),
        Part("body", "carries skin, LEDs and camera", _FIRM, "", make_body(plan)),
        Part("camera-plate", "carries the camera", _FIRM, "", make_camera_plate(plan)),
    ]


def measure_silicone(plan: Plan) -> float:
    """Returns the volume of a cast skin in ml."""
    return float(make_skin(plan, holes=False).volume()) / 1000.0


def _make_dome(plan: Plan) -> list[Part]:
    lift = (0.0, 0.0, plan.height + plan.skin)
    skin, dots = (each.rotate((180.0, 0.0, 0.0)).translate(lift) for each in make_two_colours(plan))
    colours = ("dark", "light") if plan.gel.light else ("light", "dark")
    soft = "soft filament, Shore A 60 to 85"
    below = "below the dome, from the bed; it leaves its marks outside" if plan.height else ""
    return [
        Part(f"dome-{colours[0]}", f"the {colours[0]} skin", soft, below, skin),
        Part(f"dome-{colours[1]}", f"the {colours[1]} dots in its pits", soft, below, dots),
    ]


def _make_mould(plan: Plan) -> list[Part]:
    low, frame, plug = make_mould(plan)
    return [
        Part("mould-bottom", "the lower half: the outer side of the skin", _HARD, "", low),
        Part("mould-top", "the upper half: centres the pegs", _HARD, "", frame),
        Part("pegs", "leaves a pit for each dot", f"{_HARD} or less", "", plug),
    ]
