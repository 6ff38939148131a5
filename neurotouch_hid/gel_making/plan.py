"""All measures of a gel and its housing, in mm, from the numbers of ``gel.yaml``.

The origin is the middle of the rim. In solids x goes right, y away from the user, z up; the camera
looks up from below. ``gel.yaml`` has y towards the user, so y changes its sign here and only here.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from neurotouch_hid.driver.gel_settings import GelSettings
from neurotouch_hid.driver.making_settings import THINNEST_MM, Camera, Way
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.geometry import Floats, Gel

STEEPEST_DEG: Final = 60.0
"""On a steeper part of the dome a dot would be smeared, and the camera would hardly see it."""
TALLEST_MM: Final = 250.0
"""Most printers build no higher."""
N_LEDS: Final = 12
N_SCREWS: Final = 6
TRAVEL_MM: Final = 8.0
"""The camera can be moved as far up or down, because lenses differ from their data sheets."""
PLATE_MM: Final = 6.0
"""Thickness of the plate that carries the camera."""
RING_MM: Final = 3.0
"""Thickness of the plate that carries the LEDs."""
LED_MM: Final = 3.2
"""Diameter of the hole for an LED of 3 mm."""
_LED_OUT_MM, _RING_IN_MM, _CLEAR_MM = 14.0, 3.0, 1.5


@dataclass(frozen=True, slots=True)
class Plan:
    """The measures of a gel, its mould and its housing.

    Attributes:
        gel: the gel.
        way: how it is made.
        camera: the camera.
        points: (n, 2), the dots from above, x right, y away from the user.
        radius: of the inner side of the dome at the rim.
        height: of the inner side of the dome above the rim; 0 if the gel is flat.
        skin: thickness of the skin.
        distance: from the lens to the plane of the rim.
        led_depth: from that plane down to the LEDs.
    """

    gel: Gel
    way: Way
    camera: Camera
    points: Floats
    radius: float
    height: float
    skin: float
    distance: float
    led_depth: float

    @property
    def sphere(self) -> float:
        """Radius of the sphere that the inner side is a part of; infinite if it is flat."""
        if not self.height:
            return math.inf
        return (self.radius**2 + self.height**2) / (2.0 * self.height)

    @property
    def n_steps(self) -> int:
        """Number of places between axis and rim that describe the dome to 0.01 mm."""
        return max(int(2.0 * self.radius), 8) + 1

    @property
    def flange(self) -> float:
        """Radius of the flange around the dome, and of the body's top."""
        return self.radius + 13.0

    @property
    def screws(self) -> float:
        """Radius of the circle of screws that hold the skin."""
        return self.radius + 9.5

    @property
    def tube(self) -> float:
        """Inner radius of the body."""
        return self.radius + 4.0

    @property
    def seat_z(self) -> float:
        """Height of the underside of the camera's plate."""
        return -self.distance - self.camera.pupil_mm

    @property
    def bottom_z(self) -> float:
        """Height of the body's foot."""
        return self.seat_z - self.camera.below_mm - TRAVEL_MM

    @property
    def px_per_mm(self) -> float:
        """Scale of the picture at the rim, in the camera's own pixels."""
        return find_focal(self.camera) / self.distance

    def find_height(self, r: Floats) -> Floats:
        """Returns the height of the inner side at distances from the axis, (n,)."""
        if not self.height:
            return np.zeros_like(r)
        inside = np.sqrt(np.maximum(self.sphere**2 - r**2, 0.0))
        return np.asarray(inside - (self.sphere - self.height), np.float64)

    def project(self, points: Floats) -> Floats:
        """Returns where a pinhole shows points (n, 3), in px from the middle of the picture."""
        scale = find_focal(self.camera) / (self.distance + points[:, 2])
        return np.asarray(points[:, :2] * scale[:, None], np.float64)

    def measure_fill(self) -> float:
        """Returns the share of the picture's height that the gel fills, by rays through the lens.

        Of a dome it may be another circle than the rim that looks largest.
        """
        r = np.linspace(0.0, self.radius, 301)
        points = np.column_stack([r, np.zeros_like(r), self.find_height(r)])
        return float(2.0 * self.project(points)[:, 0].max() / self.camera.height_px)

    def find_reflections(self) -> list[float]:
        """Returns at which distances from the axis a shiny skin would mirror an LED, mm.

        There the skin turns the light of an LED into the lens. A dull skin shows nothing. Nobody
        knows the place of the lamp of a first evening.
        """
        if self.way == "evening":
            return []
        r = np.linspace(-self.radius, self.radius, 4001)
        place = np.column_stack([r, self.find_height(np.abs(r))])
        lens, led = np.array([0.0, -self.distance]), np.array([self.radius, -self.led_depth])
        halves = sum((end - place) / np.hypot(*(end - place).T)[:, None] for end in (lens, led))
        slope = -r / (self.sphere - self.height + place[:, 1]) if self.height else 0.0 * r
        along = halves[:, 0] + slope * halves[:, 1]
        changes = np.flatnonzero(np.diff(np.sign(along)))
        found = sorted(round(abs(float(r[i])), 1) for i in changes)
        return list(dict.fromkeys(found))


def find_focal(camera: Camera) -> float:
    """Returns the focal length of a camera in its pixels."""
    return 0.5 * camera.height_px / math.tan(math.radians(0.5 * camera.view_deg))


def make_plan(settings: GelSettings, *, is_made: bool = False) -> Plan:
    """Returns the measures of a gel.

    Args:
        settings: content of its file.
        is_made: the gel exists already, so nobody has to be able to make it like this.

    Raises:
        NeuroTouchError: it cannot be made like this.
    """
    gel, making = settings.make(), settings.making
    height = 0.0 if making.way == "evening" else gel.dome_height_mm
    radius = max(gel.radius_mm, _find_reach(gel))
    distance = (
        2.0 * radius * find_focal(making.camera) / (making.camera.fill * making.camera.height_px)
    )
    led_depth = max(_LED_OUT_MM, (_RING_IN_MM + _CLEAR_MM) * distance / radius)
    plan = Plan(
        gel,
        making.way,
        making.camera,
        gel.points_mm * (1.0, -1.0),
        radius,
        height,
        making.skin_mm,
        distance,
        led_depth,
    )
    if not is_made:
        _check(plan)
    return plan


def _find_reach(gel: Gel) -> float:
    """Returns the radius of the circle that contains all dots."""
    return float(np.hypot(*gel.points_mm.T).max()) + 0.5 * gel.dot_mm


def _check(plan: Plan) -> None:
    reach = _find_reach(plan.gel)
    if plan.height > plan.radius or (
        plan.height and math.degrees(math.asin(reach / plan.sphere)) > STEEPEST_DEG
    ):
        raise NeuroTouchError(
            f"The dome is too steep: {plan.height:g} mm high over a radius of "
            f"{plan.radius:.4g} mm.",
            hint=f"Set 'dome_height_mm' to {_find_highest(plan.radius, reach):.1f} or less.",
        )
    if plan.way != "evening" and _find_gap(plan.gel) < THINNEST_MM:
        raise NeuroTouchError(
            f"Two dots leave {_find_gap(plan.gel):.2f} mm of skin between them, and "
            f"{THINNEST_MM:g} mm are needed.",
            hint="Set a larger 'pitch_mm' or a smaller 'dot_mm', or 'way: evening'.",
        )
    if -plan.bottom_z > TALLEST_MM:
        raise NeuroTouchError(
            f"The body would be {-plan.bottom_z:.0f} mm high, and most printers build "
            f"{TALLEST_MM:.0f} mm.",
            hint="Use a lens with a larger 'view_deg', or a smaller gel.",
        )
    high = plan.seat_z + PLATE_MM + TRAVEL_MM
    if plan.way != "evening" and high > -plan.led_depth - RING_MM - 5.0:
        raise NeuroTouchError(
            f"The camera would be {plan.distance:.0f} mm below the gel: no room for the LED ring.",
            hint="Use a lens with a smaller 'view_deg'.",
        )
    if plan.camera.lens_mm > 2.0 * (plan.tube - 12.0):
        raise NeuroTouchError(
            f"A lens of {plan.camera.lens_mm:g} mm does not fit into a body of "
            f"{2.0 * plan.tube:g} mm.",
            hint="Make a larger gel, or set a smaller 'lens_mm'.",
        )


def _find_gap(gel: Gel) -> float:
    """Returns the least width of the skin between two dots."""
    apart = np.hypot(*(gel.points_mm[:, None] - gel.points_mm).transpose(2, 0, 1))
    np.fill_diagonal(apart, np.inf)
    return float(apart.min()) - gel.dot_mm


def _find_highest(radius: float, reach: float) -> float:
    """Returns the height of the steepest dome that is allowed."""
    sphere = reach / math.sin(math.radians(STEEPEST_DEG))
    if sphere <= radius:
        return 0.57 * radius
    return sphere - math.sqrt(sphere**2 - radius**2) - 0.05
