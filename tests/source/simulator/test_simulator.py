"""Whole simulations: what a camera over a gel must look like from outside."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.source.simulator import (
    Finger,
    Simulator,
    SimulatorConfig,
    Stroke,
    StrokeTiming,
    pinch,
    press,
    push,
    sequence,
    twist,
    zoom,
)
from neurotouch_hid.source.simulator.config import SensorConfig
from neurotouch_hid.source.simulator.gel import GelMotion
from neurotouch_hid.source.simulator.optics import CameraConfig

SHORT = StrokeTiming(120_000, 100_000, 120_000)
QUIET = SimulatorConfig(sensor=SensorConfig(shot_hz=0.0, leak_hz=0.0))


def brief(stroke):
    return sequence("brief", stroke, rest_us=60_000, gap_us=20_000)


def play(script, config=None, **options):
    simulator = Simulator(script, config, **options)
    packets = list(simulator)
    return packets, simulator


def events_of(packets):
    return np.concatenate([packet.events for packet in packets])


@pytest.fixture(scope="module")
def pushed():
    return play(brief(push(0.0, 7.0, timing=SHORT)), seed=4)


def test_packets_are_equal_slices_in_order(pushed):
    packets, _ = pushed
    assert packets[0].t_begin_us == 0
    for packet, after in pairwise(packets):
        assert packet.t_end_us == after.t_begin_us == packet.t_begin_us + 10_000
    for packet in packets:
        t = packet.events["t"]
        assert (np.diff(t) >= 0).all()
        assert ((t >= packet.t_begin_us) & (t < packet.t_end_us)).all()


def test_frames_come_every_40_ms_in_the_packet_in_which_their_exposure_ended(pushed):
    packets, _ = pushed
    frames = [(packet, frame) for packet in packets for frame in packet.frames]
    ends = [frame.exposure_end_us for _, frame in frames]
    assert ends == list(range(10_000, packets[-1].t_end_us, 40_000))
    for packet, frame in frames:
        assert packet.t_begin_us <= frame.exposure_end_us < packet.t_end_us
        assert frame.exposure_begin_us == frame.exposure_end_us - 10_000
        assert frame.pixels.shape == (260, 346)
        assert frame.pixels.dtype == np.uint8


def test_same_seed_same_bits_whatever_the_slices(pushed):
    packets, _ = pushed
    others, _ = play(brief(push(0.0, 7.0, timing=SHORT)), seed=4, slice_us=33_333)
    events, other = events_of(packets), events_of(others)
    n = min(packets[-1].t_end_us, others[-1].t_end_us)
    assert np.array_equal(events[events["t"] < n], other[other["t"] < n])
    frames = [f.pixels for p in packets for f in p.frames if f.exposure_end_us < n]
    again = [f.pixels for p in others for f in p.frames if f.exposure_end_us < n]
    assert np.array_equal(frames, again)


def test_another_seed_gives_other_events(pushed):
    packets, _ = pushed
    others, _ = play(brief(push(0.0, 7.0, timing=SHORT)), seed=5)
    assert not np.array_equal(events_of(packets), events_of(others))


def test_truth_is_the_same_before_and_after(pushed):
    _, simulator = pushed
    fresh = GelMotion.truth(Simulator(brief(push(0.0, 7.0, timing=SHORT)))._motion, 250_000)
    late = simulator.truth(250_000)
    assert np.array_equal(fresh.markers_px, late.markers_px)
    assert np.array_equal(fresh.contacts_px, late.contacts_px)


def test_truth_of_a_push(pushed):
    _, simulator = pushed
    rest, held = simulator.truth(30_000), simulator.truth(280_000)
    assert rest.kind == GestureKind.NONE
    assert len(rest.contacts_px) == rest.intensity_mm == 0
    assert held.kind == GestureKind.PUSH
    assert held.intensity_mm == pytest.approx(7.0, abs=0.7)
    moved = held.contacts_px[0] - SimulatorConfig().camera.rig.centre_px
    assert moved == pytest.approx([7.0 * 2.5, 0.0], abs=2.0)
    assert simulator.truth(simulator._script.duration_us).kind == GestureKind.NONE


def test_events_lie_where_markers_move():
    packets, simulator = play(brief(push(0.0, 7.0, timing=SHORT)), QUIET)
    for packet in packets:
        if len(packet.events):
            here = [
                simulator.truth(t).markers_px for t in (packet.t_begin_us - 10_000, packet.t_end_us)
            ]
            markers = np.concatenate(here)
            points = np.column_stack([packet.events["x"], packet.events["y"]])
            gaps = np.linalg.norm(points[:, None] - markers[None], axis=2).min(axis=1)
            assert np.quantile(gaps, 0.99) < 5.0


def test_on_events_lead_and_off_events_trail():
    packets, simulator = play(brief(push(0.0, 10.0, (-4.0, 0.0), SHORT)), QUIET)
    attack = [p for p in packets if 160_000 <= p.t_begin_us < 220_000]
    lead = []
    for packet in attack:
        markers = simulator.truth(packet.t_end_us - 5_000).markers_px
        points = np.column_stack([packet.events["x"], packet.events["y"]]).astype(float)
        gaps = points[:, None] - markers[None]
        nearest = np.linalg.norm(gaps, axis=2).argmin(axis=1)
        ahead = gaps[np.arange(len(points)), nearest, 0]
        lead.append(ahead[packet.events["p"]].mean() - ahead[~packet.events["p"]].mean())
    assert min(lead) > 0.5


def test_a_noiseless_gel_at_rest_is_silent():
    packets, _ = play(sequence("rest", rest_us=200_000), QUIET)
    assert len(events_of(packets)) == 0


def test_leak_and_shot_noise_come_at_their_rates():
    config = replace(QUIET, sensor=SensorConfig(shot_hz=0.0, leak_hz=1.0))
    leak = events_of(play(sequence("rest", rest_us=1_000_000), config)[0])
    assert leak["p"].all()
    # The spread of thresholds and rates makes the mean rate a little higher than the nominal.
    assert 0.9 < len(leak) / (346 * 260) < 1.25
    config = replace(QUIET, sensor=SensorConfig(shot_hz=5.0, leak_hz=0.0))
    shot = events_of(play(sequence("rest", rest_us=200_000), config)[0])
    assert len(shot) == pytest.approx(5.0 * 0.2 * 346 * 260, rel=0.1)


def test_no_pixel_fires_within_its_refractory_period(pushed):
    events = events_of(pushed[0])
    pixel = events["y"].astype(int) * 346 + events["x"]
    order = np.lexsort((events["t"], pixel))
    gaps = np.diff(events["t"][order])[np.diff(pixel[order]) == 0]
    assert gaps.min() >= 499


def test_the_rest_frame_shows_177_dots_on_the_lattice_and_spots_outside():
    config = SimulatorConfig(camera=CameraConfig(Rig((170.0, 127.0), 2.6, 0.05)))
    packets, simulator = play(sequence("rest", rest_us=60_000), config)
    pixels = packets[1].frames[0].pixels.astype(float)
    markers = simulator.truth(0).markers_px
    plain = config.camera.rig.to_px(PAPER_GEL.points_mm)
    # Perspective and lens move markers off the similarity, but never by a third of the pitch.
    assert 0.5 < np.linalg.norm(markers - plain, axis=1).max() < 5.0
    for x, y in markers:
        near = pixels[int(y) - 3 : int(y) + 5, int(x) - 3 : int(x) + 5]
        rows, columns = np.mgrid[int(y) - 3 : int(y) + 5, int(x) - 3 : int(x) + 5]
        light = np.maximum(near - 40.0, 0.0)
        assert (light * columns).sum() / light.sum() == pytest.approx(x, abs=0.25)
        assert (light * rows).sum() / light.sum() == pytest.approx(y, abs=0.25)
    yy, xx = np.mgrid[:260, :346]
    outside = np.hypot(xx - 170.0, yy - 127.0) > 33 * 2.6
    assert pixels[outside].max() > 150


def test_motion_blurs_a_frame():
    quick = Stroke(GestureKind.PUSH, (Finger((0.0, 0.0), (14.0, 0.0)),), attack_us=150_000)
    packets, simulator = play(sequence("blur", replace(quick, hold_us=50_000), rest_us=60_000))
    frames = [frame for packet in packets for frame in packet.frames]
    still, moving = frames[0], min(frames, key=lambda f: abs(f.t_us - 205_000))
    middle = 88  # the marker under the finger
    peaks = []
    for frame in (still, moving):
        x, y = np.rint(simulator.truth(frame.t_us).markers_px[middle]).astype(int)
        peaks.append(frame.pixels[y - 3 : y + 4, x - 3 : x + 4].max())
    assert peaks[1] < 0.8 * peaks[0]


def test_a_press_magnifies_and_hardly_moves():
    _, simulator = play(brief(press(4.0, timing=SHORT)), QUIET)
    held = simulator.truth(250_000)
    assert held.intensity_mm < 1.0
    moved = np.linalg.norm(held.markers_px - simulator.truth(0).markers_px, axis=1) / 2.5
    assert 0.1 < moved.max() < 1.0


@pytest.mark.parametrize(
    ("stroke", "turn", "grow"),
    [(pinch(6.0), 0, -1), (zoom(5.0), 0, 1), (twist(0.5), 1, 0), (twist(-0.5), -1, 0)],
)
def test_fingers_do_what_the_label_says(stroke, turn, grow):
    script = brief(replace(stroke, attack_us=120_000, hold_us=100_000, release_us=120_000))
    simulator = Simulator(script)
    truth = simulator.truth(300_000)
    assert truth.kind == stroke.kind
    assert len(truth.contacts_px) == len(stroke.fingers)
    rest = np.array([finger.contact_mm for finger in stroke.fingers]) @ (1, 1j)
    now = (truth.contacts_px - SimulatorConfig().camera.rig.centre_px) @ (1, 1j) / 2.5
    ratio = (now - now.mean()) / (rest - rest.mean())
    assert (np.sign(np.angle(ratio)) * (np.abs(np.angle(ratio)) > 0.15) == turn).all()
    if grow:
        assert (np.sign(np.abs(ratio) - 1) == grow).all()


def test_intensity_is_how_far_the_fingers_middles_go_and_contacts_lie_further_out():
    stroke = replace(twist(0.5), attack_us=120_000, hold_us=100_000, release_us=120_000)
    simulator = Simulator(brief(stroke))
    held, rest = simulator.truth(300_000), simulator.truth(0)
    moved = np.linalg.norm(held.markers_px - rest.markers_px, axis=1) / 2.5
    now = SimulatorConfig().camera.rig.to_mm(held.contacts_px)
    middles = []
    for finger, contact in zip(stroke.fingers, now, strict=True):
        middle = np.hypot(*(PAPER_GEL.points_mm - finger.contact_mm).T).argmin()
        middles.append(moved[middle])
        assert np.hypot(*contact) > np.hypot(*finger.contact_mm) + 1.0
    assert held.intensity_mm == pytest.approx(np.mean(middles), rel=0.1)


def test_row_readout_gives_a_row_one_stamp():
    config = replace(QUIET, sensor=SensorConfig(row_us=50, shot_hz=1.0))
    events = events_of(play(sequence("rest", rest_us=100_000), config)[0])
    on_turn = (events["t"] - 7 * events["y"].astype(int)) % 50 == 0
    assert on_turn.mean() > 0.85  # the others were served at the end of a tick


def test_nothing_is_lost_at_full_speed():
    packets, _ = play(brief(push(0.0, 18.0, (-9.0, 0.0), StrokeTiming(165_000, 20_000, 180_000))))
    assert sum(packet.gap for packet in packets) == 0
    assert 0.5e6 < max(len(packet.events) for packet in packets) / 0.01 < 4e6
