"""The measures: where the camera is, and what cannot be made."""

import numpy as np
import pytest

from neurotouch_hid.driver.gel_file import load_gel_file
from neurotouch_hid.driver.making_settings import Camera
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.gel_making.cameras import CAMERAS, HANDS, WAYS, write_gel_file
from neurotouch_hid.gel_making.plan import make_plan
from neurotouch_hid.gel_making.shopping import list_needs
from neurotouch_hid.geometry import PAPER_GEL
from tests.gel_making.plans import plan, read, write

GRID = ("square, pitch_mm: 4, radius_mm: 30", "grid, columns: 9, rows: 7, pitch_mm: 4")


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("hand", HANDS)
@pytest.mark.parametrize("camera", CAMERAS)
def test_rays_through_the_lens_put_most_of_the_picture_on_the_gel(camera, hand, way):
    made = plan(camera, hand, way)
    # A pinhole of the angle alone: rows of the picture whose ray meets the disc of the rim.
    rows = np.linspace(-1.0, 1.0, 2001)
    slope = rows * np.tan(np.radians(0.5 * made.camera.view_deg))
    hits = np.abs(slope * made.distance) <= made.radius
    assert 0.80 <= hits.mean() <= 0.95
    assert made.measure_fill() == pytest.approx(hits.mean(), abs=0.005)


@pytest.mark.parametrize("view_deg", [25.0, 43.3, 60.0, 70.0])
def test_another_camera_s_plan_fills_the_picture_as_well(view_deg):
    camera = Camera(name="own", width_px=640, height_px=480, view_deg=view_deg)
    made = read(write_gel_file("own", camera, HANDS["large"], "evening"))
    assert 0.80 <= made.measure_fill() <= 0.95


def test_the_paper_s_own_rig_is_kept_at_its_scale():
    made = make_plan(load_gel_file(None).settings)
    assert made.px_per_mm == pytest.approx(2.5, abs=0.03)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("hand", HANDS)
@pytest.mark.parametrize("camera", CAMERAS)
def test_parts_list_says_at_which_distance_the_lens_must_be_sharp(camera, hand, way):
    made = plan(camera, hand, way)
    needed = next(each for each in list_needs(made) if each.what.startswith("camera"))
    assert f"sharp at {made.distance:.0f} mm" in needed.property


def test_a_point_that_a_shiny_skin_mirrors_obeys_the_law_of_reflection():
    made = plan()
    (r,) = made.find_reflections()
    found = []
    for side in (-1.0, 1.0):
        place = np.array([side * r, made.find_height(np.array([r]))[0]])
        normal = np.array([0.0, made.height - made.sphere]) - place
        normal /= np.hypot(*normal)
        lens, led = np.array([0.0, -made.distance]), np.array([made.radius, -made.led_depth])
        angles = [
            np.arccos(np.dot(normal, end - place) / np.hypot(*(end - place))) for end in (lens, led)
        ]
        found.append(abs(angles[0] - angles[1]))
    assert min(found) < 0.01


def test_the_dots_of_a_plan_are_those_of_the_gel_with_y_away_from_the_user():
    made = read(write(way="evening").replace(*GRID))
    np.testing.assert_array_equal(made.points, made.gel.points_mm * (1.0, -1.0))
    np.testing.assert_array_equal(plan().gel.points_mm, PAPER_GEL.points_mm)


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("dome_height_mm: 15", "dome_height_mm: 40", "too steep"),
        ("dot_mm: 1", "dot_mm: 3", "1.00 mm of skin between them"),
        ("view_deg: 43.3", "view_deg: 15", "most printers build 250 mm"),
        ("view_deg: 43.3", "view_deg: 95", "no room for the LED ring"),
        ("lens_mm: 24", "lens_mm: 40", None),
    ],
)
def test_what_cannot_be_made_is_said_with_a_fix_that_works(before, after, words):
    text = write()
    assert before in text
    if words is None:
        text = write(hand="small")
        words = "does not fit"
    with pytest.raises(NeuroTouchError, match=words) as error:
        read(text.replace(before, after))
    assert error.value.hint
    if "steep" in words:
        fixed = error.value.hint.split(" to ")[1].split(" or ")[0]
        assert read(text.replace(before, f"dome_height_mm: {fixed}")).height == float(fixed)
