"""The skin with its dots, and the mould in which it is cast."""

from typing import TYPE_CHECKING, Final

import numpy as np

from neurotouch_hid.driver.making_settings import PIT_MM
from neurotouch_hid.gel_making.plan import N_SCREWS, Plan
from neurotouch_hid.gel_making.shapes import (
    join,
    make_box,
    make_pipe,
    make_rod,
    place_around,
    spin,
    spread,
    turn,
)

if TYPE_CHECKING:
    from manifold3d import Manifold

HOLE_MM: Final = 3.4
"""Diameter of a hole that a screw M3 passes."""
_BELOW_MM: Final = 1.0
_BEYOND_MM: Final = 2.0
_FRAME_MM, _PLATE_MM, _FLOOR_MM, _WIDER_MM = 6.0, 3.0, 4.0, 9.0
_PLAY_MM: Final = 0.2
_PINS_DEG: Final = (0.0, 110.0, 250.0)  # uneven, so the halves fit in one way only


def make_dots(plan: Plan, low: float, high: float) -> "Manifold":
    """Returns an upright piece of each dot, between two heights above the inner side."""
    reach = plan.height + plan.skin + 5.0
    rods = join(
        make_rod(0.5 * plan.gel.dot_mm, -reach, reach, point) for point in plan.points.tolist()
    )
    return rods ^ (_fill_below(plan, high) - _fill_below(plan, low))


def make_skin(plan: Plan, *, holes: bool) -> "Manifold":
    """Returns the whole skin, dome and flange, in one piece.

    Args:
        plan: the measures.
        holes: with holes for the screws; silicone is punched later.
    """
    below = turn([*_trace(plan, 0.0), (plan.radius, -2.0), (0.0, -2.0)])
    skin = (_fill_outer(plan) - below).trim_by_plane((0.0, 0.0, 1.0), 0.0)
    if not holes:
        return skin
    return skin - join(
        make_rod(0.5 * HOLE_MM, -1.0, plan.skin + 1.0, point)
        for point in place_around(plan.screws, N_SCREWS).tolist()
    )


def make_two_colours(plan: Plan) -> "tuple[Manifold, Manifold]":
    """Returns the dark skin with a pit for each dot, and the light dots that fill the pits."""
    skin = make_skin(plan, holes=True)
    dots = make_dots(plan, -_BELOW_MM, PIT_MM)
    return skin - dots, skin ^ dots


def make_mould(plan: Plan) -> "tuple[Manifold, Manifold, Manifold]":
    """Returns the lower half, the frame and the plug with the pegs, each with its flat side down.

    The skin is cast upside down: the lower half is its outer side. The frame centres the plug,
    whose pegs leave the pits of the dots.
    """
    outer = plan.flange + _WIDER_MM
    top = plan.height + plan.skin + _FLOOR_MM
    pins = place_around(plan.flange + 0.5 * _WIDER_MM, 1)[0]
    low = make_pipe(0.0, outer, 0.0, top) - _fill_outer(plan)
    low -= spin(make_rod(2.7, -0.01, 4.3, pins, 1.7), _PINS_DEG)
    vent = make_box((plan.flange - 0.5, outer + 1.0), (-0.75, 0.75), (-0.01, 1.0))
    low -= spin(vent, spread(3, 60.0))
    low = low.rotate((180.0, 0.0, 0.0)).translate((0.0, 0.0, top))
    frame = make_pipe(plan.radius + _PLAY_MM, outer, -_FRAME_MM, 0.0)
    frame += spin(make_rod(2.5, -0.5, 4.0, pins, 1.5), _PINS_DEG)
    key = (plan.radius - 2.0, plan.radius + 3.0)
    frame -= make_box((key[0], key[1] + _PLAY_MM), (-2.2, 2.2), (-_FRAME_MM - 1.0, 1.0))
    holes = place_around(plan.flange - 2.5, 4, 45.0).tolist()
    frame -= join(make_rod(1.0, -_FRAME_MM - 1.0, 1.0, hole) for hole in holes)
    plug = _fill_below(plan, 0.0) ^ make_pipe(0.0, plan.radius, -_FRAME_MM, plan.height + 1.0)
    plug += make_pipe(0.0, plan.radius + 7.0, -_FRAME_MM - _PLATE_MM, -_FRAME_MM)
    plug += make_box(key, (-2.0, 2.0), (-_FRAME_MM - 0.5, 0.0))
    plug += make_dots(plan, -_BELOW_MM, PIT_MM)
    return (
        low,
        frame.translate((0.0, 0.0, _FRAME_MM)),
        plug.translate((0.0, 0.0, _FRAME_MM + _PLATE_MM)),
    )


def _fill_below(plan: Plan, above: float) -> "Manifold":
    """Returns all that is below a surface parallel to the inner side, and a little beyond it."""
    path = _trace(plan, above, _BEYOND_MM)
    low = -plan.flange
    return turn([*path, (path[-1][0], low), (0.0, low)])


def _fill_outer(plan: Plan) -> "Manifold":
    """Returns all that is below the outer side of dome and flange."""
    rim = _find_outer_rim(plan)
    dome = [(r, z) for r, z in _trace(plan, plan.skin) if r < rim - 1e-6]
    edge = [(rim, plan.skin), (plan.flange, plan.skin), (plan.flange, -1.0), (0.0, -1.0)]
    return turn([*dome, *edge])


def _trace(plan: Plan, above: float, beyond: float = 0.0) -> list[tuple[float, float]]:
    """Returns points (r, z) of a surface parallel to the inner side, from the axis to the rim.

    Args:
        plan: the measures.
        above: its distance from the inner side, upwards.
        beyond: how far it goes on after the rim.
    """
    if not plan.height:
        return [(0.0, above), (plan.radius + beyond, above)]
    sphere, centre = plan.sphere + above, plan.height - plan.sphere
    angles = [np.linspace(0.0, np.arcsin(plan.radius / plan.sphere), plan.n_steps)]
    if beyond:
        last = min((plan.radius + beyond) / plan.sphere, 1.0)
        angles.append(np.linspace(angles[0][-1], np.arcsin(last), 4)[1:])
    return [
        (float(sphere * np.sin(each)), float(centre + sphere * np.cos(each)))
        for each in np.concatenate(angles)
    ]


def _find_outer_rim(plan: Plan) -> float:
    """Returns where the outer side of the dome meets the flange."""
    if not plan.height:
        return plan.radius
    sphere, centre = plan.sphere + plan.skin, plan.height - plan.sphere
    return float(np.sqrt(sphere**2 - (plan.skin - centre) ** 2))
