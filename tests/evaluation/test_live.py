"""Delays of the line in the sensor's time: what is noted, what it tells."""

from dataclasses import replace

import numpy as np
import pytest

from neurotouch_hid.evaluation.speed.pace import (
    LOST_US,
    Probe,
    find_dot_events,
    measure_live,
    measure_machine,
    summarise_delays,
    summarise_waits,
)
from neurotouch_hid.evaluation.speed.workload import DenseSource, load_scene
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, GamepadState, Step
from neurotouch_hid.source.slice_pacer import MOVING_US

SLICE_US = 4_000


def make_packet(k, n=5):
    events = np.zeros(n, EVENT_DTYPE)
    events["t"] = k * SLICE_US + np.arange(n) * 10
    events["x"], events["y"], events["p"] = 10 * k + np.arange(n), 7, True
    return EventPacket(k * SLICE_US, (k + 1) * SLICE_US, events)


PACKETS = [make_packet(k) for k in range(3)]


def test_the_probe_counts_from_the_last_event_and_from_the_slices_end():
    class Paced:
        due_ns = 1_000_000

    spent_s = iter([5.0, 6.0])
    probe = Probe(Paced(), lambda: 1_300_000, lambda: next(spent_s))
    probe(Step(PACKETS[0], None, None, None, GamepadState(0), None))  # not warm yet
    late = replace(PACKETS[1], t_begin_us=2_000_000, t_end_us=2_004_000)
    late.events["t"] += 2_000_000 - SLICE_US
    probe(Step(late, None, None, None, GamepadState(0), None))
    empty = EventPacket(4_000_000, 4_004_000, np.empty(0, EVENT_DTYPE))
    probe(Step(empty, None, None, None, GamepadState(0), None))
    assert list(probe.due_ns) == [1_000_000, 1_000_000]
    assert list(probe.end_us) == [2_004_000, 4_004_000]
    assert list(probe.late_ns) == [300_000, 300_000]
    assert list(probe.waited_ns) == [300_000 + (SLICE_US - 40) * 1_000, 300_000]
    assert probe.measure_core() == 0.5


def test_late_lost_and_a_backlog_that_grows():
    due = [k * 4_000_000 for k in range(100)]
    told = summarise_delays(due, [200_000] * 100, [300_000] * 100)
    assert told["latency_ms"] == pytest.approx({"p50": 0.3, "p99": 0.3, "p99.9": 0.3})
    assert (told["slices"], told["late"], told["lost"], told["backlog_ms"]) == (100, 0, 0, 0)
    growing = [k * 2_000_000 for k in range(100)]
    told = summarise_delays(due, growing, growing)
    assert told["late"] == 96  # later than 4 ms; what comes after the last is not known
    assert told["lost"] == 100 - LOST_US // 2_000 - 1
    assert told["backlog_ms"] == pytest.approx(180.0)


def test_slices_that_came_as_one_are_late_when_the_next_is_due():
    told = summarise_delays([0, 8_000_000, 12_000_000], [5_000_000] * 3, [5_000_000] * 3)
    assert told["late"] == 1


def test_each_event_waits_for_the_end_of_its_slice_and_its_write():
    stamps_us = np.array([100, 4_000, 7_000, 7_999, 8_000, 8_500, 9_000])
    ends_us, late_ns = [4_000, 8_000, 9_000], [9_000_000, 500_000, 200_000]
    told = summarise_waits(stamps_us, ends_us, late_ns)  # without the first, and the last
    waits_ms = [4.5, 1.5, 0.501, 1.2, 0.7]
    assert told["mean"] == pytest.approx(np.mean(waits_ms))
    assert told["p50"] == pytest.approx(1.2)
    assert told["p99"] == pytest.approx(np.percentile(waits_ms, 99))


def test_the_events_of_the_dots_are_those_without_noise():
    assert len(find_dot_events("rest", 0.1)) < 100  # noise makes 90 in a ms
    stamps_us = find_dot_events("push", 0.9)  # it begins after 0.6 s
    assert (np.diff(stamps_us) >= 0).all()
    assert len(stamps_us) > 1_000


def test_the_whole_line_is_measured_slice_by_slice():
    scene = load_scene("push", SLICE_US, 200_000)
    told = measure_live(DenseSource(scene, 1.4, 50_000), "memory")
    assert 1 <= told["slices"] <= 101
    assert told["latency_ms"]["p50"] > 0.0
    assert told["core"] > 0.0
    assert "event_ms" not in told


def test_slices_that_follow_the_activity_are_measured_by_the_event():
    scene = load_scene("push", MOVING_US, 200_000)
    stamps_us = np.arange(1_000_000, 1_400_000, 1_000)
    told = measure_live(DenseSource(scene, 1.4), "memory", dots_us=stamps_us)
    assert 1 <= told["slices"] <= 401
    assert 0.0 < told["event_ms"]["mean"] <= told["event_ms"]["p99.9"]


def test_a_line_with_nothing_to_do_is_late_where_the_machine_is():
    source = DenseSource(load_scene("push", SLICE_US, 200_000), 0.4)
    told = measure_machine(source, is_idle=False)
    assert told["slices"] == 100  # their heads do not count
    assert told["core"] > 0.0
    assert told["latency_ms"]["p50"] > 0.0
