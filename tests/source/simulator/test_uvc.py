"""A UVC camera sends frames alone, and each of its defects does what its sentence says."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from neurotouch_hid.errors import SourceError
from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.source.simulator import (
    CameraConfig,
    LightConfig,
    SensorConfig,
    Simulator,
    SimulatorConfig,
    StrokeTiming,
    push,
    sequence,
)
from neurotouch_hid.source.simulator.nuisances import read_nuisances
from neurotouch_hid.source.simulator.optics import CameraModel, compute_light
from neurotouch_hid.source.simulator.uvc import weigh_ticks

QUIET = SimulatorConfig(
    sensor=SensorConfig(read_noise_dn=0.0, gain_spread=0.0, offset_spread_dn=0.0)
)
REST = sequence("rest", rest_us=1_000_000)
PUSH = sequence(
    "push", push(0.0, 12.0, timing=StrokeTiming(150_000, 100_000, 150_000)), rest_us=100_000
)


def play(*nuisances, script=REST, config=None):
    simulator = Simulator(script, config, nuisances=read_nuisances(nuisances), seed=1)
    packets = list(simulator)
    return simulator, packets, [frame for packet in packets for frame in packet.frames]


def test_it_sends_so_many_frames_and_no_event():
    simulator, packets, frames = play("uvc=125")
    assert not any(len(packet.events) for packet in packets)
    assert len(frames) == 125
    assert {f.exposure_begin_us % 8_000 for f in frames} == {0}
    assert {f.exposure_end_us - f.exposure_begin_us for f in frames} == {4_000}
    for packet in packets:
        assert all(packet.t_begin_us <= f.exposure_end_us < packet.t_end_us for f in packet.frames)
        assert simulator.find_labelled_times(packet) == [f.t_us for f in packet.frames]
    assert len(play("uvc=60")[2]) == pytest.approx(60, abs=1)


def test_without_a_uvc_camera_its_defects_are_refused():
    with pytest.raises(SourceError, match="needs a camera without events"):
        play("rolling")


def test_the_rows_of_a_rolling_shutter_are_exposed_one_after_another():
    weights = weigh_ticks(4_000, 12_000)
    np.testing.assert_allclose(weights.sum(axis=1), 1.0)
    middle_us = weights @ (500.0 * np.arange(weights.shape[1]) + 250.0)
    np.testing.assert_allclose(middle_us, 2_000 + np.linspace(0, 12_000, 260), atol=250.0)
    np.testing.assert_allclose(weigh_ticks(4_000, 0), np.full((260, 8), 1 / 8))


def test_a_rolling_shutter_shows_low_dots_later():
    """The dots of a frame are where the truth has them when their own row is exposed."""

    def errors(at_row):
        found = []
        for frame in frames:
            if not 150_000 < frame.t_us < 230_000:
                continue
            truth = simulator.truth(frame.t_us).markers_px
            moved = np.abs(simulator.truth(frame.t_us + 4_000).markers_px - truth)[:, 0]
            for i in np.flatnonzero((moved > 0.4) & (np.abs(truth[:, 1] - 129.5) > 12)):
                t_us = frame.t_us + at_row * round(12_000 * (truth[i, 1] - 129.5) / 259)
                x, y = simulator.truth(t_us).markers_px[i]
                window = frame.pixels[round(y) - 3 : round(y) + 4, round(x) - 3 : round(x) + 4]
                light = np.maximum(window.astype(float) - 30, 0)
                if light.any():
                    found.append((light.sum(0) @ np.arange(-3, 4)) / light.sum() + round(x) - x)
        return float(np.mean(np.abs(found)))

    simulator, packets, frames = play("uvc=60", "rolling=12", script=PUSH, config=QUIET)
    assert all(
        packet.t_begin_us <= f.exposure_end_us < packet.t_end_us
        for packet in packets
        for f in packet.frames
    )
    assert errors(at_row=1) < 0.5 * errors(at_row=0)


def test_mains_light_makes_bands_with_a_rolling_shutter_only():
    def banding(*more):
        _, _, frames = play("uvc=60", "mains=100", *more, config=flat)
        rows = [frame.pixels[:, 20:40].mean(axis=1) / usual for frame in frames[1:]]
        return max(float(np.std(row / row.mean())) for row in rows)

    light = LightConfig(black_dn=120.0, uneven=0.0, n_spots=0)
    flat = replace(QUIET, light=light)
    usual = compute_light(light, flat.camera.rig)[0][:, 20:40].mean(axis=1)
    assert banding("rolling=12") > 0.05  # 8 ms of exposure leave a quarter of the ripple
    assert banding() < 0.01


def test_gamma_brightens_the_dark():
    (plain,), (bright,) = (play("uvc", *more, config=QUIET)[2][:1] for more in ((), ("gamma=2.2",)))
    for dn in (10, 14, 100, 180):
        at = plain.pixels == dn
        assert at.any()
        expected = 255 * (dn / 255) ** (1 / 2.2)
        assert bright.pixels[at].mean() == pytest.approx(expected, abs=4.0)


def test_mjpeg_loses_more_the_lower_its_quality():
    plain = play("uvc", config=QUIET)[2][0].pixels.astype(int)
    lost = [
        np.abs(play("uvc", f"mjpeg={q}", config=QUIET)[2][0].pixels - plain).mean()
        for q in (95, 70, 20)
    ]
    assert 0.0 < lost[0] < lost[1] < lost[2]


def test_auto_exposure_goes_to_its_brightness_within_a_second():
    _, _, frames = play("uvc", "auto-exposure=60")
    means = [float(frame.pixels.mean()) for frame in frames]
    assert means[0] < 20
    assert means[-1] == pytest.approx(60, abs=2)
    assert (np.diff(means[:20]) > 0).all()


def test_dropped_frames_are_missing_and_doubled_ones_come_twice():
    assert len(play("uvc", "dropped=20")[2]) == pytest.approx(100, abs=12)
    _, _, frames = play("uvc", "doubled=20")
    assert len(frames) == 125
    again = [np.array_equal(a.pixels, b.pixels) for a, b in pairwise(frames)]
    assert sum(again) == pytest.approx(25, abs=12)
    assert not any(
        np.array_equal(a.pixels, b.pixels)
        for _, _, plain in [play("uvc")]
        for a, b in pairwise(plain)
    )


def test_a_fisheye_shows_equal_angles_equally_wide():
    flat = CameraConfig(height_mm=1e-3, distance_mm=1e6, barrel=0.0)
    half = math.radians(45.0)
    radius = PAPER_GEL.radius_mm
    angles = np.linspace(0.05, half, 8)
    middle_px = flat.rig.centre_px[0]
    points = np.column_stack([np.tan(angles) / math.tan(half) * radius, np.zeros((8, 2))])
    seen = CameraModel(replace(flat, fisheye_rad=half)).project(points)[:, 0] - middle_px
    np.testing.assert_allclose(seen / angles, seen[0] / angles[0], rtol=1e-4)
    plain = CameraModel(flat).project(points)[:, 0] - middle_px
    assert seen[-1] / plain[-1] == pytest.approx(math.pi / 4, rel=1e-3)


def test_vignetting_darkens_the_corners_and_the_ring_is_half_way_to_the_rim():
    plain, dark, ring = (
        compute_light(light, CameraConfig().rig)
        for light in (LightConfig(), LightConfig(vignetting=0.5), LightConfig(ring_glare=0.3))
    )
    assert dark[1][0, 0] / plain[1][0, 0] == pytest.approx(0.5, abs=0.01)
    assert dark[1][130, 173] == pytest.approx(plain[1][130, 173], rel=1e-3)
    more = ring[0] - plain[0]
    x, y = 172 + round(0.5 * PAPER_GEL.radius_mm * 2.5), 130
    assert more[y, x] == pytest.approx(60, abs=5)
    assert more[130, 172] < 0.1
