"""The library as it is, on an emulated DAVIS346.

Their driver and ours give the same Steps, and the pad is neutral soon after it was unplugged.
"""

import time

import numpy as np
import pytest
from neurotouch_devtools.emulator import CameraConfig, EmulatedCamera

from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import EVENT_DTYPE, Frame, GestureKind
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source.simulator import Simulator, StrokeTiming, push, sequence
from neurotouch_hid.source.slicer import Slicer
from tests.emulator.stage import finish, plug_in, run, start

pytestmark = pytest.mark.filterwarnings("ignore:DynamicImporter:ImportWarning")  # gi's own

MOST_PX = 0.2
MOST_S = 0.1
HELD = StrokeTiming(attack_us=100_000, hold_us=4_000_000, release_us=100_000)


def see(who, packets, folder):
    """What a driver gives of a scene, as a program of its own."""
    resets = who == "own"  # the other does not reset the clock, and shows nothing before
    config = CameraConfig(unpaced=True, await_reset=resets, lead_us=0 if resets else 700_000)
    n_events = sum(len(packet.events) for packet in packets)
    n_frames = sum(len(packet.frames) for packet in packets) - 1  # the last may come too late
    out = folder / f"{who}.npz"
    with plug_in(EmulatedCamera(packets, config)) as bed:
        run(bed, "-m", "tests.source.events.player", who, str(out), str(n_events), str(n_frames))
    return np.load(out)


def play(seen):
    """The Steps of that, from its first event on."""
    events = seen["events"].view(EVENT_DTYPE)
    first_us = int(events["t"][0])
    events["t"] -= first_us
    frames = [
        Frame(pixels, int(begin) - first_us, int(end) - first_us)
        for pixels, (begin, end) in zip(seen["pixels"], seen["times"], strict=True)
    ]
    slicer = Slicer(10_000, 0)
    pipeline = Pipeline.build(load_profile("spacecraft"), GestureConfig())
    packets = list(slicer.push(events, frames))
    return [pipeline.advance(packet) for packet in packets]


def test_their_driver_and_ours_give_the_same_steps(push, tmp_path):
    own, theirs = (see(who, push.packets, tmp_path) for who in ("own", "theirs"))
    assert str(own["name"]) == "davis:00000001"
    assert str(theirs["name"]) == "events:00000001"
    assert (int(own["gap"]), int(theirs["gap"])) == (0, 0)
    assert len(own["pixels"]) > 20
    ours, others = play(own), play(theirs)
    assert len(ours) == len(others)
    worst_px, n_compared = 0.0, 0
    for mine, other in zip(ours, others, strict=True):
        both = mine.markers.valid & other.markers.valid
        assert mine.markers.valid.sum() == other.markers.valid.sum()
        off = np.hypot(*(mine.markers.position_px - other.markers.position_px)[both].T)
        worst_px = max(worst_px, float(off.max(initial=0.0)))
        n_compared += int(both.sum())
        assert mine.gesture.kind is other.gesture.kind
    print(f"{n_compared} markers compared, the worst is {worst_px:.4f} px off")
    assert n_compared > 10_000
    assert worst_px <= MOST_PX
    assert [step.gesture.kind for step in ours].count(GestureKind.PUSH) > 50


def pull_while_pushing(packets):
    """Returns how long a program that plays the camera held the stick after the pull, s."""
    config = CameraConfig(lead_us=700_000)  # their driver does not reset the clock
    with plug_in(EmulatedCamera(packets, config)) as bed:
        process = start(bed, "-m", "tests.source.events.pulled")
        assert process.stdout.readline() == "pushed\n"
        pulled_s = time.monotonic()
        bed.unplug()
        return float(finish(process)) - pulled_s


def test_the_pad_is_neutral_soon_after_their_camera_was_unplugged():
    """Their driver stops all threads, or aborts the program, if it closes such a camera at once."""
    with Simulator(sequence("push", push(0.0, 10.0, timing=HELD), rest_us=200_000)) as scene:
        packets = list(scene)
    taken_s = [pull_while_pushing(packets) for _ in range(3)]
    assert all(s > 0.0 for s in taken_s)
    assert np.median(taken_s) <= MOST_S, taken_s
