"""Each nuisance does what its sentence says, and without one nothing has changed."""

import hashlib
import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from neurotouch_hid.errors import SourceError
from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.messages import EVENT_DTYPE, GestureKind
from neurotouch_hid.source.simulator import (
    SensorConfig,
    Simulator,
    SimulatorConfig,
    StrokeTiming,
    push,
    sequence,
    twist,
)
from neurotouch_hid.source.simulator.nuisances import MIXTURES, NUISANCES, disturb, read_nuisances
from neurotouch_hid.source.simulator.scenes import read_simulation
from neurotouch_hid.source.simulator.setup import Setup
from neurotouch_hid.source.simulator.simulated_people import meet_person

SHORT = StrokeTiming(120_000, 100_000, 120_000)
PUSHES = sequence(
    "pushes", push(0.0, 7.0, timing=SHORT), push(1.0, 7.0, timing=SHORT), rest_us=60_000,
    gap_us=20_000,
)  # fmt: skip
REST = sequence("rest", rest_us=400_000)
QUIET = SimulatorConfig(sensor=SensorConfig(shot_hz=0.0, leak_hz=0.0))
CLEAN = {
    "default": "2f0fb61b552aed33",
    "half-space": "bd43a34afbacf45d",
    "solid": "3c816202e47bd4f8",
}


def simulate(script=PUSHES, config=None, seed=1, **nuisances):
    named = {name.replace("_", "-"): strength for name, strength in nuisances.items()}
    return Simulator(script, config, nuisances=named, seed=seed)


def play(simulator):
    packets = list(simulator)
    events = np.concatenate([packet.events for packet in packets])
    return packets, events, [frame for packet in packets for frame in packet.frames]


def set_up(script=PUSHES, seed=1, **nuisances):
    return disturb(Setup(script, SimulatorConfig(), seed), nuisances)


def digest(simulator):
    """A hash of events, frames and labels; without the bytes that pad an event."""
    total = hashlib.sha256()
    for packet in simulator:
        for name in "txyp":
            total.update(np.ascontiguousarray(packet.events[name]).tobytes())
        for frame in packet.frames:
            total.update(frame.pixels.tobytes())
            total.update(str((frame.exposure_begin_us, frame.exposure_end_us)).encode())
            truth = simulator.truth(frame.t_us)
            contacts = np.round(truth.contacts_px, 3).tolist()
            total.update(str((int(truth.kind), contacts, round(truth.intensity_mm, 3))).encode())
    return total.hexdigest()[:16]


@pytest.mark.parametrize(
    "nuisances", [{}, {"readout": 10.0}, {"lost": 20.0}, {"jump": 1.0}, {"mains": 60.0}], ids=str
)
def test_the_bytes_of_an_event_do_not_depend_on_what_memory_held_before(nuisances):
    """Bytes that pad an event are not in its fields, but in a hash of a recording in memory."""
    for packet in Simulator(PUSHES, nuisances=nuisances):
        dirt = [np.full(1 << size, 0xEE, np.uint8) for size in range(8, 17) for _ in range(8)]
        del dirt
        clean = np.zeros(len(packet.events), EVENT_DTYPE)
        for name in "txyp":
            clean[name] = packet.events[name]
        assert packet.events.tobytes() == clean.tobytes()


@pytest.mark.parametrize("gel", CLEAN)
def test_without_a_nuisance_a_seed_gives_the_recording_that_it_always_gave(gel):
    script = sequence(
        "x", push(0.0, 7.0, timing=SHORT), twist(0.5, timing=SHORT), rest_us=60_000, gap_us=20_000
    )
    if gel == "default":
        assert digest(Simulator(script, seed=4)) == CLEAN[gel]
        return
    _, config = meet_person(3)
    config = replace(config, gel=replace(config.gel, elasticity=gel))
    assert digest(Simulator(script, config, seed=1 if gel == "half-space" else 2)) == CLEAN[gel]


@pytest.mark.parametrize("name", ["bump", "creep"])
def test_a_mount_moves_every_dot_by_as_many_mm(name):
    simulator = simulate(sequence("rest", rest_us=2_000_000), **{name: 2.0})
    moved = simulator.truth(2_000_000).markers_px - simulator.truth(0).markers_px
    assert np.hypot(*moved.T) / 2.5 == pytest.approx(2.0, abs=0.01)
    assert np.ptp(moved, axis=0).max() < 0.01


def test_a_bumped_gel_rings_and_a_label_does_not_take_it_for_a_gesture():
    simulator = simulate(sequence("rest", rest_us=2_000_000), bump=2.0)
    far = [
        np.hypot(*(simulator.truth(t).markers_px - simulator.truth(0).markers_px)[0]) / 2.5
        for t in range(600_000, 1_000_000, 4_000)
    ]
    assert far[0] == pytest.approx(0.0, abs=1e-6)
    assert max(far) > 2.2
    assert simulator.truth(700_000).kind is GestureKind.NONE


def test_a_turning_gel_turns_about_its_centre():
    simulator = simulate(sequence("rest", rest_us=1_000_000), turn=3.0)
    centre = np.array(SimulatorConfig().camera.rig.centre_px)
    before, after = ((simulator.truth(t).markers_px - centre) @ (1, 1j) for t in (0, 1_000_000))
    far = np.abs(before) > 5.0
    assert np.degrees(np.angle(after[far] / before[far])) == pytest.approx(3.0, abs=0.01)


@pytest.mark.parametrize(("name", "hz"), [("fan", 24.0), ("music", 55.0)])
def test_a_shaken_gel_has_its_frequency(name, hz):
    setup = set_up(**{name: 0.1})
    places = np.array([setup.mount[0](t)[0] for t in range(0, 1_000_000, 1_000)])
    assert np.abs(np.fft.rfft(places))[1:].argmax() + 1 == pytest.approx(hz, abs=1.0)


def test_missing_and_faint_dots_are_as_many_as_said():
    assert (set_up(missing=10.0).dots.brightness == 0.0).sum() == 18
    assert (set_up(faint=30.0).dots.brightness == 0.2).sum() == 53
    _, _, frames = play(simulate(sequence("rest", rest_us=60_000), QUIET, missing=25.0))
    places = np.rint(simulate(QUIET and REST).truth(0).markers_px).astype(int)
    seen = frames[0].pixels[places[:, 1], places[:, 0]] > 60
    assert seen.sum() == 177 - 44


def test_painted_dots_are_off_by_as_many_mm_and_a_dome_crowds_them_at_its_rim():
    off = set_up(painted=0.3).dots.points_mm - PAPER_GEL.points_mm
    assert np.hypot(*off.T) == pytest.approx(0.3)
    far, usual = np.hypot(*set_up(dome=100.0).dots.points_mm.T), np.hypot(*PAPER_GEL.points_mm.T)
    share = far[usual > 0] / usual[usual > 0]
    assert share.min() == pytest.approx(share[usual[usual > 0].argmax()])
    assert 0.85 < share.min() < 0.93
    assert share.max() > 0.99


def test_irregular_dots_differ_in_size():
    size = set_up(irregular=30.0).dots.size
    assert size.min() >= 0.7
    assert size.max() <= 1.3
    assert np.ptp(size) > 0.5


def test_a_gel_with_residue_does_not_come_back_until_the_next_touch():
    apart = sequence("x", push(0.0, 10.0, timing=SHORT), rest_us=60_000, gap_us=400_000)
    simulator = simulate(apart, residue=5.0)
    rest, end = simulator.truth(0).markers_px, simulator.truth(apart.duration_us).markers_px
    peak = simulator.truth(320_000).markers_px
    kept = np.hypot(*(end - rest).T).max() / np.hypot(*(peak - rest).T).max()
    assert kept == pytest.approx(0.05, abs=0.01)
    clean = simulate(apart)
    assert np.array_equal(clean.truth(apart.duration_us).markers_px, clean.truth(0).markers_px)


@pytest.mark.parametrize(
    ("name", "strength", "turn_degrees", "scale"),
    [("scale", 4.0, 0.0, 1.6), ("rotation", 30.0, 30.0, 1.0), ("decentring", 20.0, 0.0, 1.0)],
)
def test_a_camera_elsewhere_sees_the_gel_there(name, strength, turn_degrees, scale):
    usual, other = (s.truth(0).markers_px for s in (simulate(), simulate(**{name: strength})))
    a, b = (points @ (1, 1j) for points in (usual - usual[88], other - other[88]))
    factor = np.vdot(a, b) / np.vdot(a, a).real
    assert abs(factor) == pytest.approx(scale, rel=0.01)
    assert math.degrees(np.angle(factor)) == pytest.approx(turn_degrees, abs=0.1)
    assert (other - usual)[88] == pytest.approx([20.0 * (name == "decentring"), 0.0], abs=0.01)


def test_a_lens_moves_the_rim_by_its_strength():
    usual, barrel = (s.truth(0).markers_px for s in (simulate(), simulate(lens=-20.0)))
    centre = np.array(SimulatorConfig().camera.rig.centre_px)
    shares = np.hypot(*(barrel - centre).T) / np.maximum(np.hypot(*(usual - centre).T), 1e-9)
    rim = np.hypot(*PAPER_GEL.points_mm.T).argmax()
    assert shares[rim] == pytest.approx(0.8, abs=0.06)


def test_a_tilted_camera_sees_one_side_larger():
    points = simulate(tilt=10.0).truth(0).markers_px
    right, left = (
        points[(place == PAPER_GEL.points_mm).all(axis=1)][0]
        for place in ([24.0, 0.0], [-24.0, 0.0])
    )
    middle = points[88]
    ratio = (right[0] - middle[0]) / (middle[0] - left[0])
    assert not 0.95 < ratio < 1.05


@pytest.mark.parametrize(
    ("name", "strength", "hz"),
    [("mains", 40.0, 100), ("mains-leak", 15.0, 100), ("pwm", 30.0, 200)],
)
def test_flickering_light_has_its_frequency_in_the_rate_of_events(name, strength, hz):
    _, events, frames = play(Simulator(REST, QUIET, nuisances={name: strength}))
    assert play(Simulator(REST, QUIET))[1].size == 0
    rate = np.histogram(events["t"][events["p"]], np.arange(100_000, 400_001, 1_000))[0]
    strongest = np.abs(np.fft.rfft(rate - rate.mean())).argmax() / 0.3
    assert strongest == pytest.approx(hz, abs=4.0)
    assert len(frames) == 10


def test_a_lamp_makes_frames_brighter_from_then_on():
    _, events, frames = play(Simulator(REST, QUIET, nuisances={"lamp": 50.0}))
    dots = np.rint(simulate().truth(0).markers_px).astype(int)
    before, after = (frames[i].pixels[dots[:, 1], dots[:, 0]].mean() for i in (1, 8))
    assert after > 1.3 * before
    assert events["t"].min() > 110_000


def test_sunlight_comes_through_the_gel_and_not_through_the_housing():
    frames = play(simulate(REST, QUIET, sun=60.0))[2]
    usual = play(simulate(REST, QUIET))[2]
    more = np.mean(
        [a.pixels.astype(float) - b.pixels for a, b in zip(frames, usual, strict=True)], 0
    )
    y, x = np.mgrid[:260, :346]
    far = np.hypot(x - 172.5, y - 129.5) / 2.5
    assert more[far < 25].mean() > 5 * max(more[far > 35].mean(), 0.1)


def test_a_hands_shadow_takes_its_share_of_the_light_and_goes_with_the_hand():
    shade = set_up(shadow=40.0).shades[0]
    knot = simulate()._motion.knot(0)
    assert shade(250_000, knot).min() == pytest.approx(0.6, abs=0.01)
    alone = disturb(Setup(REST, SimulatorConfig(), 1), {"shadow": 40.0}).shades[0]
    assert alone(250_000, knot).min() > 0.99


def test_glints_are_brighter_than_dots_and_move_further():
    simulator = simulate(glints=12.0)
    motion, mark = simulator._motion, set_up(glints=12.0).marks[0]
    untouched, pushed = motion.untouched, motion.knot(60)
    rows, moved = mark(0, untouched, untouched), mark(0, pushed, untouched)
    assert len(rows) == 12
    assert (rows[:, 5] > 1.0).all()
    most = np.hypot(*(pushed.outline - untouched.outline)[:, :2].T).max()
    assert 0.0 < np.hypot(*(moved - rows)[:, :2].T).max() <= 1.7 * most


@pytest.mark.parametrize(
    ("name", "moves"),
    [
        ("dust", False),
        ("fibres", False),
        ("scratches", False),
        ("gel-dust", True),
        ("gel-fibres", True),
    ],
)
def test_dirt_on_the_gel_moves_and_dirt_on_the_lens_stays(name, moves):
    motion = simulate()._motion
    mark = set_up(**{name: 20.0}).marks[0]
    still, pushed = (
        mark(0, knot, motion.untouched) for knot in (motion.untouched, motion.knot(60))
    )
    assert len(still) == 20
    assert (np.abs(pushed - still)[:, :2].max() > 1.0) == moves


def test_the_edge_of_a_fingertip_is_a_ring_around_its_contact():
    motion, mark = simulate()._motion, set_up(edge=15.0).marks[0]
    pushed = motion.knot(60)
    rows = mark(0, pushed, motion.untouched)
    shown = rows[rows[:, 5] > 0]
    assert shown[:, 5] == pytest.approx(0.15)
    assert np.hypot(*(shown[:, :2] - pushed.contacts_px[0]).T) == pytest.approx(6.5 * 2.5)
    assert (mark(0, motion.untouched, motion.untouched)[:, 5] == 0).all()


def test_frames_of_another_exposure_are_brighter_or_darker():
    usual, over, under = (
        play(simulate(REST, QUIET, **more))[2][0].pixels.astype(float)
        for more in ({}, {"overexposed": 3.0}, {"underexposed": 8.0})
    )
    lit = usual > 20
    x, y = np.rint(simulate().truth(0).markers_px).astype(int).T
    assert np.median(over[y, x]) == 255
    assert np.median(usual[y, x]) < 200
    assert under[lit].mean() == pytest.approx(usual[lit].mean() / 8, rel=0.1)


def test_reading_frames_makes_on_events_in_two_sweeps_row_by_row():
    _, events, _ = play(simulate(REST, QUIET, readout=10.0))
    assert events["p"].all()
    phase = events["t"] % 40_000
    reset = (phase >= 40_000 - 9_153) | (phase == 0)
    signal = (phase >= 10_000) & (phase <= 19_170)
    assert (reset | signal).all()
    rows = (phase[signal] - 10_000) / 35.2
    assert np.abs(rows - events["y"][signal]).max() < 1.1
    assert 10 * 15 < len(events) / 10 < 10 * 60  # at grey 0-31: 0.0003 a pixel and frame


def test_hot_pixels_fire():
    _, events, _ = play(simulate(REST, QUIET, hot=50.0))
    pixels, fired = np.unique(events["y"] * 346 + events["x"], return_counts=True)
    assert len(pixels) == 50
    assert fired.mean() == pytest.approx(200 * 0.4, rel=0.15)


def test_lost_events_leave_gaps_and_frames_are_as_rare_as_said():
    _, events, _ = play(simulate(config=SimulatorConfig(), lost=50.0))
    assert (np.diff(events["t"]) >= 45_000).sum() >= 3
    assert len(play(simulate(REST, QUIET, frames=5.0))[2]) == 2
    assert not play(simulate(REST, QUIET, frames=0.0))[2]


def test_late_and_black_frames():
    late, usual = play(simulate(REST, QUIET, late=30.0))[2], play(simulate(REST, QUIET))[2]
    assert late[0].t_us - usual[0].t_us == 30_000
    assert np.array_equal(late[0].pixels, usual[0].pixels)
    black = [frame.pixels.max() == 0 for frame in play(simulate(REST, QUIET, black=50.0))[2]]
    assert 0 < sum(black) < 10


def test_a_jump_shifts_all_later_stamps_and_the_truth_follows():
    simulator = simulate(jump=20.0)
    packets, events, _ = play(simulator)
    gaps = np.array([b.t_begin_us - a.t_end_us for a, b in pairwise(packets)])
    assert sorted(set(gaps.tolist())) == [0, 20_000_000]
    end = packets[-1].t_end_us - 20_000_000
    assert (np.diff(events["t"]) >= 0).all()
    moment = end - 60_000
    shifted, usual = simulator.truth(moment + 20_000_000), simulate().truth(moment)
    assert np.array_equal(shifted.markers_px, usual.markers_px)
    assert shifted.t_us == moment + 20_000_000


def test_in_a_pause_nothing_arrives_and_a_hand_is_on_when_the_camera_starts():
    packets, _, _ = play(simulate(pause=0.3))
    gaps = [b.t_begin_us - a.t_end_us for a, b in pairwise(packets)]
    assert max(gaps) == 300_000
    simulator = simulate(**{"hand-on": 0.2})
    packets, _, frames = play(simulator)
    times = [t for packet in packets for t in simulator.find_labelled_times(packet)]
    assert packets[0].t_begin_us == 0
    assert simulator.truth(0).kind is GestureKind.PUSH
    assert 0 <= times[0] < 40_000
    assert times == [frame.t_us for frame in frames]


def test_labels_need_no_frames():
    simulator = simulate(frames=0.0)
    times = [t for packet in simulator for t in simulator.find_labelled_times(packet)]
    frames = play(simulate())[2]
    assert times == [frame.t_us for frame in frames]


def test_taps_are_as_short_as_said_and_slow_pushes_as_slow():
    for stroke in set_up(taps=60.0).strokes:
        assert stroke.attack_us + stroke.hold_us + stroke.release_us == 60_000
        assert math.hypot(*stroke.fingers[0].drag_mm) == pytest.approx(5.0)
    slow = set_up(slow=2.0)
    assert slow.strokes[0].attack_us == 3_500_000
    assert slow.strokes[1].start_us - slow.strokes[0].end_us == 20_000
    assert slow.script.duration_us == slow.strokes[1].end_us + 20_000


def test_tips_and_gloves_change_the_contact():
    assert {f.radius_mm for s in set_up(tips=4.0).strokes for f in s.fingers} == {4.0}
    assert {f.radius_mm for s in set_up(gloves=3.0).strokes for f in s.fingers} == {9.5}


def test_a_palm_moves_the_gel_and_is_in_no_label():
    alone = sequence("x", push(0.0, 5.0, (-8.0, -8.0), SHORT), rest_us=2_500_000, gap_us=2_000_000)
    simulator = simulate(alone, palm=2.0)
    resting, playing = simulator.truth(2_400_000), simulator.truth(2_800_000)
    assert resting.kind is GestureKind.NONE
    assert np.hypot(*(resting.markers_px - simulator.truth(0).markers_px).T).max() > 1.5
    assert playing.kind is GestureKind.PUSH
    assert len(playing.contacts_px) == 1


OF_A_WEBCAM = ("rolling", "gamma", "mjpeg", "auto-exposure")


@pytest.mark.parametrize("name", [*NUISANCES, *MIXTURES])
def test_every_nuisance_and_mixture_plays_in_order_of_time(name):
    script = sequence("x", push(0.0, 5.0, timing=SHORT), rest_us=20_000, gap_us=0)
    nuisances = read_nuisances(["uvc", name] if name in OF_A_WEBCAM else [name])
    simulator = Simulator(script, nuisances=nuisances, seed=2)
    for packet, _ in zip(simulator, range(12), strict=False):
        t = packet.events["t"]
        assert (np.diff(t) >= 0).all()
        assert ((t >= packet.t_begin_us) & (t < packet.t_end_us)).all()


def test_a_nuisance_says_what_it_is_in_one_sentence():
    for nuisance in NUISANCES.values():
        assert nuisance.what.endswith(".")
        assert "``" not in nuisance.what
        assert nuisance.least <= nuisance.strength <= nuisance.most
    for strengths in MIXTURES.values():
        assert strengths == read_nuisances(f"{name}={s}" for name, s in strengths.items())


def test_names_and_strengths_are_read_and_refused():
    assert read_nuisances(["bump", "mild", "bump=3"])["bump"] == 3.0
    assert read_simulation("tour,bump=1,lens") == ("tour", {"bump": 1.0, "lens": -20.0})
    with pytest.raises(SourceError, match="no nuisance called 'glint'") as refused:
        read_nuisances(["glint"])
    assert refused.value.hint == "Did you mean glints?"
    for text in ("bump=11", "bump=x", "bump=nan", "bump="):
        with pytest.raises(SourceError, match="is no strength of the nuisance bump"):
            read_nuisances([text])


def test_a_mixture_does_not_depend_on_the_order_of_its_parts():
    parts = dict(list(MIXTURES["mild"].items())[:8])
    turned = dict(reversed(parts.items()))
    truths = [Simulator(REST, nuisances=each).truth(300_000) for each in (parts, turned)]
    assert np.array_equal(truths[0].markers_px, truths[1].markers_px)


def test_a_flood_is_no_more_than_a_camera_can_send():
    packets, events, _ = play(simulate(sequence("rest", rest_us=40_000), pwm=200.0))
    end_us = packets[-1].t_end_us
    assert 9 * end_us < len(events) <= 12 * end_us
    assert (np.diff(events["t"]) >= 0).all()
