"""Latencies as a distribution; the measuring itself is tested in a real kernel."""

import numpy as np
import pytest
from neurotouch_devtools.bench.latency import EDGES_MS, Latency, Sent, evaluate

MS = 1_000_000


def test_a_distribution():
    latency = Latency.of(np.array([*[0.4] * 90, *[1.5] * 9, 70.0]))
    assert (latency.n, latency.p50, latency.most) == (100, 0.4, 70.0)
    assert 1.5 <= latency.p99 <= latency.p999 <= 70.0
    assert sum(latency.histogram) == 100
    assert latency.histogram[EDGES_MS.index(0.5)] == 90
    assert latency.histogram[EDGES_MS.index(2.0)] == 9
    assert latency.histogram[-1] == 1


def test_what_is_sent_is_compared_with_what_is_received_one_for_one():
    sent = [Sent(10_000 * n, 10 * n * MS, 10 * n * MS + 2 * MS) for n in range(4)]
    received = [(10 * n * MS, 10 * n * MS + 3 * MS) for n in range(4)]
    result = evaluate(sent, received)
    assert result["line"]["p50_ms"] == pytest.approx(3.0)
    assert result["device"]["p50_ms"] == pytest.approx(1.0)
    assert result["frames"] == 4
    assert result["sensor_time_kept"] == 1.0


def test_stamps_of_another_clock_are_noticed():
    sent = [Sent(10_000 * n, 0, 0) for n in range(3)]
    received = [(0, 1), (10 * MS, 1), (21 * MS, 1)]
    assert evaluate(sent, received)["sensor_time_kept"] == 0.5


def test_one_frame_says_nothing_about_stamps():
    assert evaluate([Sent(0, 0, 0)], [(0, 1)])["sensor_time_kept"] is None
