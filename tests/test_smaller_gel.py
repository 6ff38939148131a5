"""The housing clamps a smaller gel nearer to its middle: simulator and recogniser know it."""

import numpy as np
import pytest

from neurotouch_hid.geometry import MOST_MARKERS, Rig, make_gel, place_square
from neurotouch_hid.gesture.elastic.kernels.arrays import NOW
from neurotouch_hid.gesture.elastic.kernels.fit import RIM_WIDTH_MM
from neurotouch_hid.source.simulator import GelConfig, SimulatorConfig, push, sequence
from neurotouch_hid.source.simulator.gel import ELASTICITIES, GelMotion
from neurotouch_hid.source.simulator.optics import CameraModel
from tests.gesture.stages import Fingers
from tests.layouts import LAYOUTS
from tests.reference import gesture_elastic as reference

SMALL = make_gel("small", place_square(2.0, 15.0), pitch_mm=2.0, radius_mm=15.0)


def test_a_layout_that_fills_the_gel_of_the_paper_has_its_rim():
    rims_mm = {name: gel.rim_mm for name, gel in LAYOUTS.items()}
    assert [rims_mm[name] for name in ("paper", "hex", "rings", "points")] == [31.0] * 4
    assert rims_mm["grid"] == pytest.approx(np.hypot(18.0, 12.0) + 2.0)
    assert SMALL.rim_mm == pytest.approx(np.hypot(14.0, 4.0) + 1.0)


@pytest.mark.parametrize("elasticity", ELASTICITIES)
def test_the_simulated_gel_is_held_at_its_rim(elasticity):
    config = SimulatorConfig().show(SMALL)
    script = sequence("x", push(0.0, 3.0, (0.0, 0.0)), rest_us=60_000)
    gel = GelConfig(elasticity=elasticity, layout=SMALL)
    motion = GelMotion(script, CameraModel(config.camera, SMALL), gel)
    moved_px = motion.truth(700_000).markers_px - motion.untouched.outline[:, :2]
    far = np.hypot(*moved_px.T)
    outermost = np.hypot(*SMALL.points_mm.T) > 14.5
    assert far[outermost].mean() < 0.25 * far.max()  # held as the gel of the paper: 0.36


def test_fingers_are_found_as_a_smaller_gel_follows_them(monkeypatch):
    monkeypatch.setattr(reference, "RIM", SMALL.rim_mm)
    centres, radii = np.array([[-7.0, 1.0], [7.0, -1.0]]), np.array([6.5, 6.0])
    columns = reference.columns(SMALL.points_mm, centres, radii)
    fingers = Fingers(gel=SMALL)
    fingers.place(SMALL.points_mm.astype(np.float32), Rig((0.0, 0.0), 1.0))
    for size_mm in (1.0, 2.0, 3.0, 3.0, 3.0, 3.0):
        moved = columns @ (size_mm, 0.0, 0.0, -size_mm, 0.0, 0.0)
        motion = fingers.update(moved, np.ones(len(moved), np.bool_), 0.05, forming=True)
    assert motion.n_fingers == 2
    assert motion.error_mm < 0.02  # with the rim of the gel of the paper: 0.06
    assert np.hypot(*fingers.arrays.fits[NOW]["centres"][:2].T).max() <= SMALL.rim_mm - RIM_WIDTH_MM


def test_a_gel_with_more_markers_than_kernels_have_places_for_is_refused():
    many = make_gel("many", place_square(1.0, 12.0), pitch_mm=1.0, radius_mm=12.0)
    assert many.n_markers > MOST_MARKERS
    with pytest.raises(ValueError, match=f"at most {MOST_MARKERS} markers, not {many.n_markers}"):
        Fingers(gel=many)
