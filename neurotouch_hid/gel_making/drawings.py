"""The drawings of a gel: cut through the middle, the dots as the camera sees them, the wiring."""

from typing import Final

import numpy as np

from neurotouch_hid.gel_making.plan import N_LEDS, PLATE_MM, RING_MM, TRAVEL_MM, Plan
from neurotouch_hid.gel_making.sheet import GREY, Circle, Path, Sheet, Words

_WALL: Final = 2.4
_SMALL: Final = 3.6
_READABLE: Final = 120.0
"""The words of a taller drawing are larger, because a page shows it smaller."""

Point = tuple[float, float]


def draw_cut(plan: Plan) -> Sheet:
    """Returns the gel and its housing cut through the middle, with the camera's field, 1:1."""
    top = plan.height + plan.skin + 6.0
    left = plan.flange + 8.0
    bottom = -plan.distance - 18.0 if plan.way == "evening" else plan.bottom_z
    height = top - bottom + 8.0
    grow = max(1.0, height / _READABLE)
    width = left + plan.flange + 12.0 + 62.0 * grow
    sheet = Sheet(width, height, f"The gel {plan.gel.name} on its camera, cut through the middle")

    def at(x: float, z: float) -> Point:
        return left + x, top - z + 4.0

    def fill(outline: list[Point], grey: float) -> None:
        for side in (-1.0, 1.0):
            sheet.add(
                Path(tuple(at(side * r, z) for r, z in outline), 0.25, closed=True, fill=grey)
            )

    r = np.linspace(0.0, plan.radius, 40)
    dome = [
        at(side * each, z)
        for side, order in ((-1.0, -1), (1.0, 1))
        for each, z in list(zip(r.tolist(), plan.find_height(r).tolist(), strict=True))[::order]
    ]
    lens = at(0.0, -plan.distance)
    sheet.add(Path((lens, *dome), 0.0, closed=True, fill=0.92))
    if plan.way != "evening":
        tube, ledge = plan.tube, -plan.led_depth - RING_MM
        outer = tube + _WALL
        fill(
            [
                (tube, 0.0),
                (plan.flange, 0.0),
                (plan.flange, -8.0),
                (outer, -8.0 - plan.flange + outer),
                (outer, bottom + 3.0),
                (plan.flange, bottom + 3.0),
                (plan.flange, bottom),
                (tube, bottom),
                (tube, ledge - 4.0),
                (tube - 2.0, ledge - 2.0),
                (tube - 2.0, ledge),
                (tube, ledge),
            ],
            GREY,
        )
        low, high = ledge, -plan.led_depth
        fill([(plan.radius - 3.0, low), (tube, low), (tube, high), (plan.radius - 3.0, high)], 0.6)
        hole, seat = 0.5 * plan.camera.lens_mm, plan.seat_z
        fill([(hole, seat), (tube, seat), (tube, seat + PLATE_MM), (hole, seat + PLATE_MM)], 0.6)
        inner, far = plan.radius + 3.0, plan.flange
        low, high = plan.skin, plan.skin + 3.0
        fill([(inner, low), (far, low), (far, high), (inner, high)], GREY)
    else:
        wall = plan.flange - 2.0
        sheet.line(at(-wall, 0.0), at(-wall, bottom), at(wall, bottom), at(wall, 0.0), dash=True)
    flange = [(plan.radius, 0.0), (plan.flange, 0.0), (plan.flange, plan.skin)]
    fill([*flange, (plan.radius + 0.03 * plan.skin, plan.skin)], 0.2)
    inner_line = list(zip(r.tolist(), plan.find_height(r).tolist(), strict=True))
    fill([*inner_line, *((x, z) for x, z in reversed(_offset(plan, r)))], 0.2)
    for side in (-1.0, 1.0):
        sheet.line(lens, at(side * plan.radius, 0.0), dash=True)
    box = 0.5 * min(plan.camera.lens_mm, 24.0)
    eye, down = -plan.distance, min(-plan.distance - 10.0, plan.seat_z)
    sheet.add(
        Path((at(-box, eye), at(box, eye), at(box, down), at(-box, down)), 0.4, True, fill=1.0),
        Words(*at(0.0, eye - 6.5), "camera", _SMALL * min(grow, 1.4), "middle"),
    )
    x = plan.flange + 6.0
    tall = f"{plan.height:g} mm high" if plan.height else "flat"
    facts = [
        (plan.height + plan.skin, f"skin: {2 * plan.radius:.4g} mm wide, {tall}"),
        (-0.5 * plan.distance, f"{plan.distance:.0f} mm from the rim to the lens"),
        (eye, f"lens: {plan.camera.view_deg:g}° from top to bottom"),
    ]
    if plan.way == "evening":
        facts.append((bottom + 2.0, "box, closed against light"))
    else:
        facts.insert(1, (-plan.led_depth, f"LEDs: {plan.led_depth:.0f} mm below the rim"))
        facts.append((plan.seat_z, f"plate: {TRAVEL_MM:g} mm up or down"))
        facts.append((plan.bottom_z + 1.0, f"body: {-plan.bottom_z:.0f} mm high"))
    before = 1e9
    for z, text in facts:
        place = min(z, before - 6.0 * grow)
        before = place
        sheet.line(at(x - 4.0, z), at(x + 1.0, place), width=0.15)
        sheet.add(Words(*at(x + 2.0, place - 1.2), text, _SMALL * grow))
    return sheet


def draw_dots(plan: Plan) -> Sheet:
    """Returns the camera's picture of the gel: its frame, the rim and the dots, 100 mm wide."""
    camera = plan.camera
    scale = 100.0 / camera.width_px
    height = camera.height_px * scale
    sheet = Sheet(104.0, height + 4.0, f"What the camera {camera.name} sees of the gel")
    sheet.add(
        Path(((2.0, 2.0), (102.0, 2.0), (102.0, 2.0 + height), (2.0, 2.0 + height)), 0.3, True)
    )
    middle = np.array([52.0, 2.0 + 0.5 * height])
    z = plan.find_height(np.hypot(*plan.points.T))
    places = middle + plan.project(np.column_stack([plan.points * (-1.0, -1.0), z])) * scale
    x, y = middle.tolist()
    dot = 0.5 * plan.gel.dot_mm * plan.px_per_mm * scale
    sheet.add(Circle(x, y, plan.radius * plan.px_per_mm * scale, 0.2, fill=0.9))
    for distance in plan.find_reflections():
        sheet.add(Circle(x, y, distance * plan.px_per_mm * scale, 0.2, dash=True))
    sheet.add(*(Circle(at_x, at_y, dot, 0.1, fill=1.0) for at_x, at_y in places.tolist()))
    return sheet


def draw_wiring() -> Sheet:
    """Returns the circuit of the LED ring, and of the transistor that may switch it."""
    sheet = Sheet(160.0, 92.0, "Circuit of the LED ring, and of a strobe")
    rail, ground = 14.0, 62.0
    sheet.line((8.0, rail), (102.0, rail), width=0.4)
    sheet.line((24.0, ground), (102.0, ground), width=0.4)
    sheet.add(
        Words(4.0, rail - 3.0, "+5 V (red wire of a USB cable)", _SMALL),
        Words(58.0, ground + 6.0, f"{N_LEDS} such branches, side by side", _SMALL, "middle"),
    )
    for x in (30.0, 52.0, 92.0):
        _draw_branch(sheet, x, rail, ground)
    sheet.add(Words(72.0, 0.5 * (rail + ground), ". . .", 8.0, "middle"))
    x = 24.0
    sheet.line((x, ground), (x, 70.0), width=0.4)
    sheet.add(
        Circle(x, 75.0, 5.0, 0.4, fill=1.0),
        Words(x, 76.4, "T", 4.0, "middle"),
        Words(4.0, 91.0, "0 V (black wire)", _SMALL),
    )
    sheet.line((x, 80.0), (x, 86.0), width=0.4)
    sheet.line((8.0, 86.0), (102.0, 86.0), width=0.4)
    sheet.line((29.0, 75.0), (44.0, 75.0), width=0.4)
    sheet.line((44.0, 75.0), (44.0, 77.0), width=0.4)
    sheet.add(
        Path(((42.5, 77.0), (45.5, 77.0), (45.5, 83.0), (42.5, 83.0)), 0.4, True),
        Words(48.0, 81.5, "10 kΩ up to 3.3 V, not to 0 V", _SMALL),
        Words(48.0, 76.0, "gate; 100 Ω to a pin of 3.3 V", _SMALL),
        Words(106.0, 20.0, "R = 120 Ω, 0.25 W", _SMALL),
        Words(106.0, 26.0, "LED: white, 3 mm, diffuse", _SMALL),
        Words(106.0, 32.0, "16 mA each,", _SMALL),
        Words(106.0, 38.0, f"{16 * N_LEDS} mA together", _SMALL),
        Words(106.0, 70.0, "T: only for a strobe.", _SMALL),
        Words(106.0, 76.0, "Without it, join", _SMALL),
        Words(106.0, 82.0, "both lines below.", _SMALL),
    )
    return sheet


def _draw_branch(sheet: Sheet, x: float, top: float, bottom: float) -> None:
    sheet.line((x, top), (x, top + 6.0), width=0.4)
    sheet.add(
        Path(((x - 2, top + 6), (x + 2, top + 6), (x + 2, top + 18), (x - 2, top + 18)), 0.4, True),
        Words(x + 4.0, top + 13.5, "R", _SMALL),
    )
    sheet.line((x, top + 18.0), (x, top + 26.0), width=0.4)
    tip = top + 33.0
    sheet.add(Path(((x - 3.5, top + 26), (x + 3.5, top + 26), (x, tip)), 0.4, True, fill=0.9))
    sheet.line((x - 3.5, tip), (x + 3.5, tip), width=0.4)
    sheet.line((x, tip), (x, bottom), width=0.4)
    sheet.add(Words(x + 5.0, top + 31.0, "LED", _SMALL))


def _offset(plan: Plan, r: "np.ndarray[tuple[int], np.dtype[np.float64]]") -> list[Point]:
    """Returns points (r, z) of the outer side of the skin."""
    z = plan.find_height(r)
    if not plan.height:
        return [(x, plan.skin) for x in r.tolist()]
    grow = 1.0 + plan.skin / plan.sphere
    centre = plan.height - plan.sphere
    return [(x * grow, centre + (y - centre) * grow) for x, y in zip(r, z, strict=True)]
