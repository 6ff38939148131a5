"""Our event model beside another one (eventcv, v2e's pixel in Rust) on the same moving picture."""

import numpy as np
import pytest

from neurotouch_hid.source.simulator import Simulator, SimulatorConfig, StrokeTiming, push, sequence
from neurotouch_hid.source.simulator.config import SensorConfig
from neurotouch_hid.source.simulator.gel import KNOT_US, GelConfig, GelMotion
from neurotouch_hid.source.simulator.kernels import optics as kernels
from neurotouch_hid.source.simulator.optics import (
    CameraConfig,
    CameraModel,
    LightConfig,
    compute_light,
    marker_profile,
)

eventcv = pytest.importorskip("eventcv")

BEGIN_US, END_US = 130_000, 250_000  # the attack
SCRIPT = sequence(
    "x", push(0.0, 8.0, (-4.0, 0.0), StrokeTiming(160_000, 20_000, 160_000)), rest_us=60_000
)


def render():
    """The picture every ms, (n, 260, 346) float64 DN."""
    camera = CameraConfig()
    motion = GelMotion(SCRIPT, CameraModel(camera), GelConfig())
    base, light = compute_light(LightConfig(), camera.rig)
    canvas = np.zeros(base.size, kernels.POINT_DTYPE)
    canvas["base"] = canvas["image"] = base.ravel()
    canvas["light"] = light.ravel()
    lists, counts = np.zeros((2, base.size), np.uint32), np.zeros(1, kernels.COUNTS_DTYPE)
    picture = kernels.Picture(canvas, *lists, *marker_profile(0.6), counts)
    pictures = []
    for t in range(BEGIN_US, END_US, 1000):
        index, rest = divmod(t, KNOT_US)
        knots = np.stack([motion.knot(index + k).outline for k in (-1, 0, 1, 2)])
        kernels.draw_markers(knots, rest / KNOT_US, picture)
        pictures.append(canvas["image"].reshape(base.shape).astype(float))
    return np.array(pictures)


def test_rate_and_places_agree_with_another_model():
    linear = render() / 255.0
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    other = eventcv.simulate(
        np.rint(255 * np.clip(srgb, 0, 1)).astype(np.uint8),
        fps=1000, seed=1, pos_thres=0.2, neg_thres=0.2, sigma_thres=0.03, cutoff_hz=300.0,
        leak_rate_hz=0.0, shot_noise_rate_hz=0.0, refractory_us=500,
    ).numpy()  # fmt: skip
    config = SimulatorConfig(sensor=SensorConfig(shot_hz=0.0, leak_hz=0.0))
    packets = list(Simulator(SCRIPT, config))
    ours = np.concatenate([packet.events for packet in packets])
    ours = ours[(ours["t"] >= BEGIN_US) & (ours["t"] < END_US)]
    assert 0.5 < len(ours) / len(other) < 2.0
    maps = []
    for x, y in ((ours["x"], ours["y"]), (other[:, 0], other[:, 1])):
        grid = np.zeros((130, 173))
        np.add.at(grid, (y.astype(int) // 2, x.astype(int) // 2), 1.0)
        maps.append(grid.ravel())
    assert np.corrcoef(maps)[0, 1] > 0.9
