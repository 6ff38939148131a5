"""The driver against the emulated camera, which was written without it: sound and with faults.

The camera's time passes only while the driver looks for data, so that a busy machine changes
neither what is seen nor when a fault strikes.
"""

import gc
import logging
import resource
import threading
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
from neurotouch_devtools.emulator import Fault, Identity

from neurotouch_hid.driver.source_opening import describe_source
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame
from neurotouch_hid.source.davis import DavisSource
from tests.source.davis.cable import Cable, Clock, emulate
from tests.source.davis.test_source import assert_sound
from tests.waiting import wait_until

N_SLICES = 40
LATE_SLICES = 10
"""What comes after a fault: every fault strikes before."""
END_X = 345
"""Of the last event, and of no other."""
REST_US = 50_000
"""From the last event until its frame, too, has been read."""
PATIENCE_S = 120.0

CLOCK = Clock()


def make_scene(n_slices=N_SLICES, seed=1):
    """Events all over the sensor and 25 frames a second, each one told from all others."""
    rng = np.random.default_rng(seed)
    packets = []
    for k in range(n_slices):
        begin_us = 10_000 * k
        events = np.zeros(200, EVENT_DTYPE)
        events["t"] = np.sort(rng.integers(begin_us, begin_us + 10_000, len(events)))
        events["x"], events["y"] = rng.integers(END_X, size=200), rng.integers(260, size=200)
        events["p"] = rng.integers(2, size=200)
        pixels = rng.integers(256, size=(260, 346)).astype(np.uint8)
        frames = (Frame(pixels, begin_us + 2_000, begin_us + 6_000),) if k % 4 == 3 else ()
        packets.append(EventPacket(begin_us, begin_us + 10_000, events, frames))
    packets[-1].events["x"][-1] = END_X
    return packets


def see(scene, faults=(), **options):
    """A camera that sees a scene, in the time of ``CLOCK``."""
    return emulate(scene, faults, CLOCK, **options)


def play(camera, cable=None, until=lambda stats, packets: True):
    """All packets until the scene is over, and what the source says."""
    cable = cable or Cable(camera, CLOCK.step)
    packets = []
    with open_cable(cable) as source:
        for _ in play_scene(source, packets):
            if is_over(packets) and until(source.stats(), packets):
                break
        stats = source.stats()
    assert cable.n_open == 0
    return packets, stats


def play_scene(source, packets):
    """Collects packets, for as long as the caller wants and not for ever."""
    deadline = time.monotonic() + PATIENCE_S
    for packet in source.poll():
        packets += [packet] if packet is not None else []
        yield
        assert time.monotonic() < deadline, source.stats()


def open_cable(cable, serial="", **options):
    """A source that forgives a busy machine; the camera needs no time to settle."""
    options |= {"max_delay_us": 1_000_000_000, "sleep_s": lambda _: None}
    return DavisSource(serial, cameras=cable, **options)


def is_over(packets):
    """The scene's last event is there, and some time after it."""
    for packet in reversed(packets):
        last = packet.events[-1:]
        if len(last):
            ended_us = packets[-1].t_begin_us - last["t"][0]
            return last["x"][0] == END_X and ended_us > REST_US
    return False


def gather(packets):
    return np.concatenate([packet.events for packet in packets])


def assert_all_there(packets, scene):
    """Every event and frame, the same but for one shift of time."""
    found, given = gather(packets), gather(scene)
    assert len(found) == len(given)
    for name in ("x", "y", "p"):
        assert np.array_equal(found[name], given[name])
    assert len(np.unique(found["t"] - given["t"])) == 1
    assert_frames_there(packets, scene, shift_us=found["t"][0] - given["t"][0])


def assert_frames_there(packets, scene, shift_us):
    frames = [frame for packet in packets for frame in packet.frames]
    originals = [frame for packet in scene for frame in packet.frames]
    assert len(frames) == len(originals)
    for frame, original in zip(frames, originals, strict=True):
        assert np.array_equal(frame.pixels, original.pixels)
        assert frame.exposure_begin_us == original.exposure_begin_us + shift_us
        assert frame.exposure_end_us == original.exposure_end_us + shift_us


@pytest.mark.parametrize("orientation", range(8))
def test_events_and_frames_arrive_as_they_were_seen(orientation):
    scene = make_scene(12)
    packets, stats = play(see(scene, orientation=orientation))
    assert_sound(packets)
    assert_all_there(packets, scene)
    assert not any(packet.gap for packet in packets)
    assert (stats.n_connects, stats.n_faults, stats.n_dropped) == (1, 0, 0)
    assert stats.decoder == type(stats.decoder)()


@pytest.mark.parametrize("fault", ["short+5x9", "odd+5x9", "stale", "timeout+5"])
def test_what_is_only_late_cut_or_stale_loses_nothing(fault):
    scene = make_scene()
    packets, stats = play(see(scene, [Fault.parse(fault)]))
    assert_sound(packets)
    assert_all_there(packets, scene)
    assert stats.n_connects == 1


def test_a_short_silence_of_the_camera_is_a_time_without_events():
    scene = make_scene()
    packets, stats = play(see(scene, [Fault.parse("silence+9")]))
    assert_sound(packets)
    found, given = gather(packets), gather(scene)
    for name in ("x", "y", "p"):
        assert np.array_equal(found[name], given[name])
    assert not any(packet.gap for packet in packets)
    assert stats.n_connects == 1


@pytest.mark.parametrize(
    ("fault", "counter"),
    [
        ("range+9x3", "bad_columns"),
        ("range+9x3", "bad_rows"),
        ("backward+9x3", "backward"),
        ("unknown+9x3", "unknown"),
    ],
)
def test_malformed_words_are_counted_and_harm_no_event(fault, counter):
    scene = make_scene()
    packets, stats = play(see(scene, [Fault.parse(fault)]))
    assert_sound(packets)
    assert getattr(stats.decoder, counter) >= 3
    assert stats.n_connects == 1
    assert len(gather(packets)) == pytest.approx(len(gather(scene)), abs=10)


@pytest.mark.parametrize("fault", ["babble+9x3", "protocol+9x3", "stall+9", "reset+9"])
def test_what_is_lost_is_a_gap_and_play_goes_on(fault):
    scene = make_scene()
    packets, stats = play(see(scene, [Fault.parse(fault)]))
    assert_sound(packets)
    assert sum(packet.gap for packet in packets) >= 1
    assert stats.n_connects == 1
    assert_end_is_there(packets, scene)


def assert_end_is_there(packets, scene):
    found, given = gather(packets), gather(scene[-LATE_SLICES:])
    for name in ("x", "y", "p"):
        assert np.array_equal(found[name][-len(given) :], given[name])


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        ("missing+9", "The camera's "),  # which sign comes first depends on the words
        ("garbage+9", "The camera's clock jumped ahead by "),
        ("wrap+9", "The camera's clock jumped ahead by 2147 s, so its data is out of step; "),
    ],
)
def test_a_stream_out_of_step_is_noticed_and_started_again(fault, reason, caplog):
    scene = make_scene()
    packets = []
    with open_cable(Cable(see(scene, [Fault.parse(fault)]), CLOCK.step)) as source:
        for _ in play_scene(source, packets):
            if is_over(packets) and source.stats().n_connects > 1:
                break
        stats, described = source.stats(), describe_source(source)
    assert_sound(packets)
    assert (stats.n_connects, stats.n_restarts, stats.trouble) == (2, 1, "")
    assert described == "davis:00000001, restarts because its data made no sense: 1"
    assert sum(packet.gap for packet in packets) >= 1
    assert_end_is_there(packets, scene)
    assert packets[-1].t_end_us < 60_000_000  # nobody believed the wrong clock
    said, plays = (record.getMessage() for record in caplog.records)
    assert said.startswith(reason)
    assert said.endswith(
        "the camera is started again. The gamepad works again as soon as the camera does."
    )
    assert plays == "The camera 00000001 plays."


def test_what_the_camera_drops_is_a_gap_within_a_second():
    scene = make_scene()
    camera = see(scene, [Fault.parse("overflow+9")])
    packets, stats = play(camera, until=lambda stats, packets: any(p.gap for p in packets))
    assert_sound(packets)
    assert sum(packet.gap for packet in packets) >= stats.n_dropped == camera.n_dropped > 100
    assert_end_is_there(packets, scene)


@pytest.mark.parametrize("fault", ["suspend+9", "stall+9x3"])
def test_a_camera_that_fails_is_set_up_anew(fault):
    scene = make_scene()
    packets, stats = play(
        see(scene, [Fault.parse(fault)]), until=lambda stats, packets: stats.n_connects > 1
    )
    assert_sound(packets)
    assert stats.n_connects == 2
    assert sum(packet.gap for packet in packets) >= 1
    assert_end_is_there(packets, scene)


@pytest.mark.parametrize(
    "fault",
    [
        *("unplug@open+3", "unplug@configure", "unplug@configure+30", "unplug@configure+99"),
        *("unplug+9", "stall@open+3", "stall@configure+95", "timeout@configure+30", "short@open+2"),
    ],
)
def test_a_camera_that_goes_at_any_stage_is_played_when_it_is_back(fault):
    scene = make_scene()
    cable = Cable(see(scene, [Fault.parse(fault)]), CLOCK.step)
    packets = []
    with open_cable(cable, wait=True) as source:
        for _ in play_scene(source, packets):
            if cable.camera is None:
                cable.plug(see(scene))
            if is_over(packets):
                break
    assert_sound(packets)
    assert_end_is_there(packets, scene)
    assert cable.n_open == 0


@pytest.mark.parametrize("fault", ["unplug@stop", "stall@stop+2", "timeout@stop+5"])
def test_a_fault_while_stopping_gives_the_camera_back_all_the_same(fault):
    cable = Cable(see(make_scene(5), [Fault.parse(fault)]), CLOCK.step)
    packets, _ = play(cable.camera, cable)
    assert_sound(packets)


def exchange(cable, serial):
    """Play until the first camera goes; the source and its turns, another camera plugged in."""
    scene = make_scene()
    cable.plug(see(scene, [Fault.parse("unplug+9")], identity=Identity(serial="00000001")))
    source = open_cable(cable, serial)
    turns = source.poll()
    wait_until(lambda: (next(turns), cable.camera)[1] is None)
    wait_until(lambda: next(turns) is None)
    cable.plug(see(scene, identity=Identity(serial="00000002")))
    return source, turns


class Storm(Cable):
    """A new camera each time one is looked for, which is pulled out while it streams."""

    def choose(self, serial):
        self.plug(see((), [Fault.parse("unplug+1")]))
        return super().choose(serial)


def test_a_thousand_plugs_leave_nothing_behind():
    # In a process of its own: what other tests left in the heap would be counted too.
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as alone:
        left = np.array(alone.submit(weather, range(200, 1001, 200)).result(6 * PATIENCE_S))
    fds, threads, objects, memory = np.diff(left, axis=0).T
    assert not fds.any()
    assert not threads.any()
    # A leak shows in every step, what the heap takes at once in one. For each plug:
    assert np.median(objects) < 200 * 1
    assert np.median(memory) < 200 * 1024


def weather(plugs):
    """What is there after each number of plugs."""
    logging.disable()
    left = []
    with open_cable(Storm(step=CLOCK.step), wait=True) as source:
        turns = source.poll()
        for n in plugs:
            wait_until(lambda: (next(turns), source.stats().n_connects >= n)[1], PATIENCE_S)  # noqa: B023
            gc.collect()
            left.append(count_what_is_there())
    return left


def count_what_is_there():
    """Descriptors, threads, objects, and bytes of memory."""
    n_descriptors = sum(1 for _ in Path("/proc/self/fd").iterdir())
    memory = int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()
    return n_descriptors, threading.active_count(), len(gc.get_objects()), memory


def test_another_camera_is_not_taken_for_the_chosen_one():
    cable = Cable(step=CLOCK.step)
    source, turns = exchange(cable, "00000001")
    with source:
        assert [next(turns) for _ in range(5)] == [None] * 5
        cable.plug(see(make_scene(), identity=Identity(serial="00000001")))
        wait_until(lambda: next(turns) is not None)
        assert source.stats().n_connects == 2


def test_without_a_choice_the_camera_may_be_exchanged_for_another():
    cable = Cable(step=CLOCK.step)
    source, turns = exchange(cable, "")
    with source:
        first = next(packet for packet in turns if packet is not None)
        assert first.gap
        assert source.stats().serial == "00000002"
