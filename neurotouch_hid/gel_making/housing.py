"""The housing: clamp, LED ring, body, and the plate that carries the camera."""

from typing import TYPE_CHECKING, Final

from neurotouch_hid.driver.making_settings import THINNEST_MM
from neurotouch_hid.gel_making.plan import (
    LED_MM,
    N_LEDS,
    N_SCREWS,
    PLATE_MM,
    RING_MM,
    TRAVEL_MM,
    Plan,
)
from neurotouch_hid.gel_making.shapes import (
    join,
    make_box,
    make_opening,
    make_pipe,
    make_rod,
    place_around,
    spin,
    spread,
    turn,
)
from neurotouch_hid.gel_making.skin import HOLE_MM

if TYPE_CHECKING:
    from manifold3d import Manifold

_WALL_MM, _TOP_MM, _FOOT_MM, _CLAMP_MM = 2.4, 8.0, 3.0, 3.0
_PILOT_MM: Final = 2.6  # a screw M3 cuts its own thread
_PLAY_MM: Final = 0.3
_SLOTS_DEG: Final = (60.0, 120.0, 240.0, 300.0)  # away from doors, notch and board
_DOOR_MM, _ARCH_MM = 14.0, 44.0
_BOARD_MM: Final = (13.0, 17.5)  # half of the distance of a board's holes, both ways


def make_clamp(plan: Plan) -> "Manifold":
    """Returns the ring that presses the skin on the body; its inner edge is rounded off."""
    inner = plan.radius + 3.0
    ring = turn(
        [
            (inner, 0.0),
            (plan.flange, 0.0),
            (plan.flange, _CLAMP_MM - 0.5),
            (plan.flange - 0.5, _CLAMP_MM),
            (inner + 1.5, _CLAMP_MM),
            (inner, _CLAMP_MM - 1.5),
        ]
    )
    return ring - _drill(plan, HOLE_MM, -1.0, _CLAMP_MM + 1.0)


def make_led_ring(plan: Plan) -> "Manifold":
    """Returns the ring that carries the LEDs around the camera's view."""
    ring = make_pipe(plan.radius - 3.0, plan.tube - _PLAY_MM, 0.0, RING_MM)
    return ring - join(
        make_rod(0.5 * LED_MM, -1.0, RING_MM + 1.0, point)
        for point in place_around(plan.radius, N_LEDS, 15.0).tolist()
    )


def make_body(plan: Plan) -> "Manifold":
    """Returns the body, upright: seat of the skin, ledge of the LED ring, slots of the camera."""
    tube, outer, flange = plan.tube, plan.tube + _WALL_MM, plan.flange
    bottom, ledge = plan.bottom_z, -plan.led_depth - RING_MM
    body = turn(
        [
            (tube, bottom),
            (flange, bottom),
            (flange, bottom + _FOOT_MM),
            (outer, bottom + _FOOT_MM),
            (outer, -_TOP_MM - (flange - outer)),  # a cone of 45° below the top
            (flange, -_TOP_MM),
            (flange, 0.0),
            (tube, 0.0),
            (tube, ledge),
            (tube - 2.0, ledge),
            (tube - 2.0, ledge - 2.0),
            (tube, ledge - 4.0),
        ]
    )
    body -= _drill(plan, _PILOT_MM, -_TOP_MM + 1.0, 1.0)
    seat = plan.seat_z + 0.5 * PLATE_MM
    slot = make_opening(HOLE_MM, seat - TRAVEL_MM, seat + TRAVEL_MM + 0.5 * HOLE_MM)
    body -= spin(slot, _SLOTS_DEG)
    feet = place_around(flange - 3.2, 4, 45.0).tolist()
    body -= join(make_rod(2.0, bottom - 1.0, bottom + _FOOT_MM + 1.0, foot) for foot in feet)
    if plan.camera.seat == "straps":  # a camera wider than the body looks out on both sides
        width = min(_ARCH_MM, 1.3 * tube)
        door = make_opening(width, bottom - 1.0, plan.seat_z - TRAVEL_MM + 0.5 * width)
        doors = [0.0, 180.0]
    else:
        door = make_opening(_DOOR_MM, bottom - 1.0, bottom + 20.0)
        doors = [90.0]
    body -= spin(door, doors)
    return body.translate((0.0, 0.0, -bottom))


def make_camera_plate(plan: Plan) -> "Manifold":
    """Returns the plate that slides in the body, with the seat of the camera and a cable notch."""
    radius = plan.tube - 0.4
    plate = make_pipe(0.0, radius, 0.0, PLATE_MM)
    plate -= make_rod(0.5 * plan.camera.lens_mm, -1.0, PLATE_MM + 1.0)
    pilot = make_opening(_PILOT_MM, THINNEST_MM + 0.3, PLATE_MM - THINNEST_MM, 60.0)
    plate -= spin(pilot.translate((radius - 8.0, 0.0, 0.0)), _SLOTS_DEG)
    notch = make_box((radius - 5.0, radius + 1.0), (-4.0, 4.0), (-1.0, PLATE_MM + 1.0))
    plate -= notch.rotate((0.0, 0.0, 90.0))
    if plan.camera.seat == "board":
        near, far = (2.0**0.5 * each for each in _BOARD_MM)
        slot = make_box((near, far), (-1.2, 1.2), (-1.0, PLATE_MM + 1.0))
        return plate - spin(slot, spread(4, 45.0))
    at = 0.5 * plan.camera.lens_mm + 3.0
    slit = make_box((at, at + 3.0), (-3.0, 3.0), (-1.0, PLATE_MM + 1.0))
    return plate - spin(slit, (30.0, 150.0, 210.0, 330.0))


def _drill(plan: Plan, diameter: float, low: float, high: float) -> "Manifold":
    """Returns the holes of the screws around the skin."""
    return join(
        make_rod(0.5 * diameter, low, high, point)
        for point in place_around(plan.screws, N_SCREWS).tolist()
    )
