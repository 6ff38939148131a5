"""The loop keeps the pad safe: neutral at the end, on stop, on stall, on failure."""

import threading
import time
from collections import deque
from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import Mock

import pytest

from neurotouch_hid.device import MemoryDevice
from neurotouch_hid.errors import GelNotFoundError
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import Button, GamepadState
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline, run_pipeline
from neurotouch_hid.runtime.stall_guard import FORGOTTEN_S, LIVE_STALL_S, STALL_S, StallGuard
from tests.waiting import wait_until


@pytest.fixture
def line() -> Pipeline:
    return Pipeline.build(load_profile("spacecraft"), GestureConfig())


def held(push, until_us=1_500_000):
    """The packets up to the middle of the hold: the stick is pushed when they end."""
    return [packet for packet in push.packets if packet.t_end_us <= until_us]


def test_end_of_the_source_in_mid_gesture_sends_neutral(push, line):
    device = MemoryDevice()
    stats = run_pipeline(held(push), line, device)
    assert not device.states[-2].is_neutral
    assert device.states[-1].is_neutral
    assert stats.slices == 150
    assert stats.sensor_s == 1.5
    assert stats.events == sum(len(packet.events) for packet in held(push))


def test_stop_ends_after_the_slice_and_sends_neutral(push, line):
    device, stop = MemoryDevice(), threading.Event()

    def stop_in_the_hold(step):
        if step.gesture.t_us >= 1_300_000:
            stop.set()

    stats = run_pipeline(push.packets, line, device, [stop_in_the_hold], stop=stop)
    assert stats.slices == 130
    assert device.states[-1].is_neutral


def test_failing_source_sends_neutral_and_passes_the_error_on(push, line):
    device = MemoryDevice()

    def broken():
        yield from held(push)
        raise OSError("the camera is gone")

    with pytest.raises(OSError, match="the camera is gone"):
        run_pipeline(broken(), line, device)
    assert device.states[-1].is_neutral


def test_stalled_source_sends_neutral_while_it_is_silent(push, line):
    device = MemoryDevice()
    seen = []

    def stalling():
        yield from held(push)
        assert not device.states[-1].is_neutral
        wait_until(lambda: device.states[-1].is_neutral)
        seen.append(device.states[-1])

    run_pipeline(stalling(), line, device)
    assert seen[0].is_neutral


@pytest.mark.parametrize("is_live", [True, False])
def test_a_gesture_before_a_silence_counts_no_more_unless_it_is_recorded(
    push, line, is_live, monkeypatch
):
    monkeypatch.setattr("neurotouch_hid.runtime.stall_guard.FORGOTTEN_S", STALL_S)
    line.has_frame_thread = is_live
    device, told = MemoryDevice(), []

    def stalling():
        yield from held(push)
        wait_until(lambda: device.states[-1].is_neutral)
        told.append(len(device.states))
        yield from (packet for packet in push.packets if 1_500_000 < packet.t_end_us <= 1_800_000)

    run_pipeline(stalling(), line, device)
    assert not device.states[told[0] - 2].is_neutral
    assert all(state.is_neutral for state in [*device.states][told[0] :]) == is_live


class Clock:
    """The kernel's clocks, of which one goes on while the machine sleeps; a test moves it on."""

    def __init__(self):
        self.now_s = 1000.0

    def read(self, clock):
        return self.now_s if clock == time.CLOCK_BOOTTIME else 1000.0


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(time, "clock_gettime", clock.read)
    return clock


def test_a_machine_that_slept_has_stalled(clock):
    device = MemoryDevice()
    with StallGuard(device, STALL_S) as guard:
        guard.feed()
        assert not guard.take_silence()
        clock.now_s += 3600.0
        assert guard.take_silence()  # before the next step
        guard.feed()
        assert guard.take_silence()  # and also if it slept within one
        assert not guard.take_silence()


def test_a_machine_that_slept_shows_neutral_before_anything_else_happens(clock):
    device = MemoryDevice()
    with StallGuard(device, 0.01) as guard:
        guard.feed()
        device.write(GamepadState(0, frozenset({Button.A})))
        clock.now_s += 3600.0
        wait_until(lambda: device.states[-1].is_neutral)
    assert device.states[-1].is_neutral


def test_a_short_silence_releases_the_pad_and_the_gesture_goes_on(clock):
    """A slow machine stalls again and again, and must be able to play."""
    with StallGuard(MemoryDevice(), STALL_S) as guard:
        guard.feed()
        clock.now_s += FORGOTTEN_S - 2**-6
        assert not guard.take_silence()
        guard.feed()
        assert not guard.take_silence()
        clock.now_s += FORGOTTEN_S
        assert guard.take_silence()


def test_a_step_is_late_as_soon_as_its_time_is_over(clock):
    """Not a moment later: by this clock, time passes only here."""
    device = MemoryDevice()
    with StallGuard(device, 2**-6) as guard:
        guard.feed()
        device.write(GamepadState(0, frozenset({Button.A})))
        clock.now_s += 2**-6
        wait_until(lambda: device.states[-1].is_neutral)
        assert device.states[-1].is_neutral
    assert "stall guard" not in [thread.name for thread in threading.enumerate()]


class Done:
    """The guard's event, in whose ``wait`` the clock moves on; steps are finished meanwhile.

    ``fed_s`` are the times of these steps after the guard's start.
    """

    def __init__(self, clock, fed_s, n_waits):
        self.clock, self.fed_s, self.n_waits = clock, deque(fed_s), n_waits
        self.waits_s = []
        self.guard = None

    def wait(self, wait_s):
        if len(self.waits_s) == self.n_waits:
            return True
        self.waits_s.append(wait_s)
        end_s = self.clock.now_s + wait_s
        while self.fed_s and 1000.0 + self.fed_s[0] <= end_s:
            self.clock.now_s = 1000.0 + self.fed_s.popleft()
            self.guard.feed()
        self.clock.now_s = end_s
        return False


@pytest.fixture
def watch(clock, monkeypatch):
    """Lets a guard of 1/8 s watch; returns how long it waited, and the states of a held button."""

    def work(fed_s, n_waits):
        device, done = MemoryDevice(), Done(clock, fed_s, n_waits)
        device.write(GamepadState(0, frozenset({Button.A})))
        inline = SimpleNamespace(Event=lambda: done, Thread=Mock())  # its thread is this one
        monkeypatch.setattr("neurotouch_hid.runtime.stall_guard.threading", inline)
        done.guard = StallGuard(device, 0.125)
        done.guard._watch()
        return done.waits_s, [*device.states]

    return work


def test_a_guard_that_is_fed_releases_nothing_and_waits_for_what_is_left(watch):
    waits_s, states = watch([0.0625, 0.15625, 0.25], 3)
    assert waits_s == [0.125, 0.0625, 0.09375]
    assert len(states) == 1
    assert not states[-1].is_neutral


def test_a_guard_that_is_not_fed_releases_at_once_and_looks_again(watch):
    waits_s, states = watch([0.0625], 4)
    assert waits_s == [0.125, 0.0625, 0.125, 0.125]
    assert [state.is_neutral for state in states] == [False, True]


def test_a_guard_keeps_no_process_from_ending():
    with StallGuard(MemoryDevice(), 60.0):
        (thread,) = [each for each in threading.enumerate() if each.name == "stall guard"]
        assert thread.daemon


def test_source_without_a_gel_is_an_error_that_says_why(push, line):
    dark = [
        replace(packet, frames=tuple(replace(f, pixels=f.pixels // 64) for f in packet.frames))
        for packet in held(push, 500_000)
    ]
    with pytest.raises(GelNotFoundError, match=r"No gel .*: the picture is dark") as caught:
        run_pipeline(dark, line, MemoryDevice())
    assert "LED ring" in caught.value.hint


def test_source_without_frames_is_an_error_that_says_so(push, line):
    blind = [replace(packet, frames=()) for packet in held(push, 500_000)]
    with pytest.raises(GelNotFoundError, match="no picture"):
        run_pipeline(blind, line, MemoryDevice())


def test_a_camera_may_miss_one_beat_and_is_given_up_within_a_tenth_of_a_second():
    beat_s = 2**15 / 1e6  # its clock wraps, and says so
    assert 2 * beat_s < LIVE_STALL_S < 0.1 < STALL_S


class Live:
    """A camera that sends packets, and then none, for a reason or for none."""

    name, rig = "live", None
    is_live, is_simulated = True, False
    n_restarts = 0

    def __init__(self, packets, trouble=""):
        self._packets, self._reason = packets, trouble
        self.trouble = ""

    def __iter__(self):
        raise AssertionError

    def poll(self):
        yield from self._packets
        self.trouble = self._reason
        while True:
            yield None

    def close(self):
        pass

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass


def test_while_a_live_source_has_nothing_the_loop_turns_obeys_and_ends(push, line):
    stop, n_turns = threading.Event(), []

    def count():
        n_turns.append(1)
        if len(n_turns) == 60:
            stop.set()

    stats = run_pipeline(Live(push.packets[:50]), line, MemoryDevice(), stop=stop, on_round=count)
    assert stats.slices == 50
    assert len(n_turns) == 60


@pytest.mark.parametrize("trouble", ["", "The camera is gone."])
def test_a_camera_that_knows_it_has_failed_releases_the_pad_at_once(
    push, line, monkeypatch, trouble
):
    monkeypatch.setattr("neurotouch_hid.runtime.loop.LIVE_STALL_S", 10_000.0)
    packets, device, stop, states = held(push), MemoryDevice(), threading.Event(), []

    def look():
        states.append(device.states[-1] if device.states else None)
        if len(states) > len(packets):
            stop.set()

    run_pipeline(Live(packets, trouble), line, device, stop=stop, on_round=look)
    assert not states[len(packets) - 1].is_neutral
    assert states[len(packets)].is_neutral == bool(trouble)


@pytest.mark.parametrize("fps", [125, 60, 30, 15])
def test_a_source_of_pictures_may_miss_one_and_is_given_up_before_three(
    push, line, monkeypatch, fps
):
    guards = []

    class Kept(StallGuard):
        def __init__(self, device, stall_s):
            super().__init__(device, stall_s)
            guards.append(self)

    monkeypatch.setattr("neurotouch_hid.runtime.loop.StallGuard", Kept)

    class Video(Live):
        period_s, n_lost = 1 / fps, 0

        def poll(self):
            yield from push.packets[:50]

    run_pipeline(Video([]), line, MemoryDevice())
    (guard,) = guards
    assert 2 / fps < guard.stall_s < max(0.1, 3 / fps)
