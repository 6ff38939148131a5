"""The score of a gel that was made: each planted fault is named, with what to change.

The simulator draws the pictures; it is none of our gels, but it has all the faults.
"""

from dataclasses import replace

import numpy as np
import pytest

from neurotouch_hid.doctor.finding import CheckStatus
from neurotouch_hid.doctor.gel import Seen, examine_frames
from neurotouch_hid.doctor.gel_score import score_gel
from neurotouch_hid.driver.gel_file import load_gel_file
from neurotouch_hid.gel_making.plan import make_plan
from neurotouch_hid.geometry import NOMINAL_PX_PER_MM, PAPER_GEL, Rig
from neurotouch_hid.messages import Frame
from neurotouch_hid.source.simulator import Simulator, find_scene
from neurotouch_hid.source.simulator.config import (
    CameraConfig,
    LightConfig,
    SensorConfig,
    SimulatorConfig,
)
from neurotouch_hid.source.video.view_search import ViewSearch
from neurotouch_hid.source.view import ViewTable, whole_view
from neurotouch_hid.tracker import GelFinder

PLAN = make_plan(load_gel_file(None).settings)
MIDDLE = (172.5, 129.5)
N_FRAMES = 30


def simulate(config=None, n=N_FRAMES, scene="rest"):
    """Frames of a gel, at rest if no other scene is given."""
    frames = []
    with Simulator(find_scene(scene), config or SimulatorConfig()) as source:
        for packet in source:
            frames += packet.frames
            if len(frames) >= n:
                return frames[:n]
    raise AssertionError


@pytest.fixture(scope="module")
def good():
    return simulate()


def change(frames, paint):
    """The same frames, painted over."""
    changed = []
    for frame in frames:
        pixels = frame.pixels.copy()
        paint(pixels)
        changed.append(Frame(pixels, frame.exposure_begin_us, frame.exposure_end_us))
    return changed


def score(frames, *, planned=True, is_video=False, hz=25.0, view=None, plan=PLAN):
    seen = Seen("sim:rest", len(frames) / hz, 0, 0, tuple(frames), is_video=is_video, view=view)
    return score_gel(seen, examine_frames(seen.frames, plan.gel).state, plan, planned=planned)


def troubles(result):
    """The findings that are not in order, by name."""
    bad = {each.check: each for each in result.findings if each.status is not CheckStatus.OK}
    assert all(each.fix for each in bad.values() if each.status is not CheckStatus.SKIPPED)
    return bad


def places(markers):
    return Rig(MIDDLE, NOMINAL_PX_PER_MM).to_px(PAPER_GEL.points_mm[markers])


def cover(pixels, points, radius, grey):
    y, x = np.mgrid[: pixels.shape[0], : pixels.shape[1]]
    for cx, cy in points:
        pixels[np.hypot(x - cx, y - cy) < radius] = grey


def test_a_good_gel_has_no_fault(good):
    result = score(good)
    assert not troubles(result)
    assert result.is_good
    figures = result.figures
    assert figures["dots_found"] == 177
    assert figures["px_per_mm"] == pytest.approx(2.5, abs=0.1)
    assert figures["fill"] == pytest.approx(0.58, abs=0.03)
    assert 0.15 < figures["intensity_error_mm"] < 0.3
    assert result.line.startswith("177 of 177 dots; blurred by 0.")
    assert result.line.endswith("; all in order")


def test_dots_that_a_hand_moves_are_not_blamed_on_the_light_alone():
    bad = troubles(score(simulate(n=45, scene="push-left")[-N_FRAMES:]))
    assert bad["intensity"].fix.startswith("Was the gel touched? Then check again.")


def test_three_missing_dots_are_named(good):
    lacking = [20, 88, 150]
    result = score(change(good, lambda pixels: cover(pixels, places(lacking), 4.0, 14)))
    bad = troubles(result)
    assert set(bad) == {"dots"}
    assert "174 of 177 dots" in bad["dots"].sentence
    assert bad["dots"].sentence.count("row") == 3
    assert result.figures["missing"] == lacking
    assert result.is_good


def test_very_many_missing_dots_are_a_failure(good):
    lacking = list(range(3, 177, 7))
    result = score(change(good, lambda pixels: cover(pixels, places(lacking), 4.0, 14)))
    assert troubles(result)["dots"].status is CheckStatus.FAILED
    assert not result.is_good


def test_glare_is_named_with_its_place(good):
    def shine(pixels):
        y, x = np.mgrid[: pixels.shape[0], : pixels.shape[1]]
        glow = 90.0 * np.exp(-((x - 212) ** 2 + (y - 90) ** 2) / (2 * 15.0**2))
        pixels[:] = np.minimum(pixels + glow, 255).astype(np.uint8)

    bad = troubles(score(change(good, shine)))
    assert bad["glare"].sentence.startswith("Glare at the top right")


def test_the_led_ring_s_reflection_is_glare():
    bad = troubles(score(simulate(SimulatorConfig(light=LightConfig(ring_glare=0.6)))))
    assert "glare" in bad


def test_bright_spots_are_glare(good):
    spots = [(222, 129 + step) for step in (-15, -5, 5, 15)]

    def paint(pixels):
        cover(pixels, [(x + 5, y + 5) for x, y in spots], 2.0, 255)

    bad = troubles(score(change(good, paint)))
    assert "right" in bad["glare"].sentence


def test_a_lens_out_of_focus():
    bad = troubles(score(simulate(SimulatorConfig(sensor=SensorConfig(blur_px=2.2)))))
    assert "focus" in bad
    assert "lens" in bad["focus"].fix


def test_a_line_says_the_first_thing_to_change():
    result = score(simulate(SimulatorConfig(sensor=SensorConfig(blur_px=2.2))))
    assert "Turn the lens" in result.line
    assert "blurred by 0" not in result.line


@pytest.mark.parametrize(("px_per_mm", "way", "off_mm"), [(1.9, "nearer", 41), (3.2, "away", 28)])
def test_a_wrong_scale_is_told_in_mm(px_per_mm, way, off_mm):
    config = SimulatorConfig(camera=CameraConfig(rig=Rig(MIDDLE, px_per_mm)))
    bad = troubles(score(simulate(config)))
    words = bad["scale"].fix.split()
    assert words[-1] == f"{way}."
    assert float(words[3]) == pytest.approx(off_mm, abs=6)


def test_without_a_plan_of_the_camera_only_a_very_wrong_scale_counts():
    config = SimulatorConfig(camera=CameraConfig(rig=Rig(MIDDLE, 3.2)))
    assert "scale" not in troubles(score(simulate(config), planned=False))
    config = SimulatorConfig(camera=CameraConfig(rig=Rig(MIDDLE, 1.6)))
    assert "scale" in troubles(score(simulate(config), planned=False))


def test_faint_dots():
    bad = troubles(score(simulate(SimulatorConfig(light=LightConfig(white_dn=48.0)))))
    assert "contrast" in bad


def test_dots_off_their_places(good):
    rng = np.random.default_rng(4)
    points = Rig(MIDDLE, NOMINAL_PX_PER_MM).to_px(
        PAPER_GEL.points_mm + rng.normal(0.0, 0.4, PAPER_GEL.points_mm.shape)
    )

    def paint(pixels):
        pixels[:] = 14
        y, x = np.mgrid[: pixels.shape[0], : pixels.shape[1]]
        for cx, cy in points:
            near = np.s_[int(cy) - 5 : int(cy) + 6, int(cx) - 5 : int(cx) + 6]
            far = (x[near] - cx) ** 2 + (y[near] - cy) ** 2
            pixels[near] = np.maximum(pixels[near], 14 + 150 * np.exp(-far / 2.5))

    assert "places" in troubles(score(change(good, paint)))


def test_a_gel_beside_the_middle():
    config = SimulatorConfig(camera=CameraConfig(rig=Rig((205.0, 129.5), NOMINAL_PX_PER_MM)))
    bad = troubles(score(simulate(config)))
    assert set(bad) == {"middle"}
    assert "+32 px" in bad["middle"].sentence or "+33 px" in bad["middle"].sentence


def test_a_dark_picture_is_a_failure(good):
    result = score(change(good, lambda pixels: pixels.fill(3)))
    assert not result.is_good
    assert "dark" in troubles(result)["gel"].sentence


def test_no_picture_is_a_failure():
    result = score_gel(None, None, PLAN, planned=True)
    assert not result.is_good


def test_the_scale_of_a_video_camera_is_that_of_its_own_picture(good):
    """The gel is shown twice as large in a picture of twice the size; the frames are the same."""
    large = [np.kron(frame.pixels, np.ones((2, 2), np.uint8)) for frame in good]
    search = ViewSearch(GelFinder(PAPER_GEL), ViewTable(whole_view(692, 520)))
    frames = []
    for pixels, frame in zip(large, good, strict=True):
        search.update(pixels)
        canonical = np.empty((260, 346), np.uint8)
        search.table.draw(pixels, canonical)
        frames.append(replace(frame, pixels=canonical))
    assert search.is_found
    result = score(frames[5:], is_video=True, hz=30.0, view=search.table.view)
    assert result.figures["px_per_mm"] == pytest.approx(5.0, abs=0.2)
    assert result.figures["fill"] == pytest.approx(0.58, abs=0.03)
    assert set(troubles(result)) == {"intensity"}  # 30 pictures/s are few
