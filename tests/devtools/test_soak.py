"""The soak: weighed once a minute of sensor time, and growth told from settling."""

import numpy as np
import pytest
from neurotouch_devtools.bench.soak import Scale, measure_growth, measure_soak

from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, GamepadState, Step


def test_it_weighs_once_a_minute_of_sensor_time():
    weights = iter([200.0, 201.0, 202.0])
    said = []
    scale = Scale(said.append, lambda: next(weights))
    for k in range(0, 150, 10):
        begin_us = 7 + k * 1_000_000
        packet = EventPacket(begin_us, begin_us + 10_000_000, np.empty(0, EVENT_DTYPE))
        scale(Step(packet, None, None, None, GamepadState(0), None))
    assert scale.rss_mb == [200.0, 201.0]
    assert said == ["1 min: 200.0 MB", "2 min: 201.0 MB"]


def test_growth_is_told_from_settling():
    assert measure_growth([100.0, 180.0] + [200.0] * 8) == pytest.approx(0.0, abs=1e-6)
    leaking = [200.0 + minute / 60.0 for minute in range(10)]  # 1 MB an hour
    assert measure_growth(leaking) == pytest.approx(1024.0)
    assert measure_growth([200.0, 300.0]) == 0.0


def test_a_minute_of_play_is_weighed():
    result = measure_soak("neurotouch", 1.0, lambda _: None, 400_000)
    assert len(result["rss_mb"]) == 1
    assert 50.0 < result["rss_mb"][0] < 2_000.0
