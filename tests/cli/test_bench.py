"""The table of ``neurotouch bench``: every figure beside its goal, and whether it is reached."""

import pytest

from neurotouch_hid.cli.bench import _format

STAGES = (
    "davis_decode_events_per_s",
    "view_640x480_ms",
    "view_1920x1200_ms",
    "tracker_events_per_s",
    "rest_ms",
    "tracker_ms",
    "gesture_ms",
    "profile_ms",
    "advance_ms",
)
LOADS = ("at_1_khz", "at_250_hz", "at_12_million", "play", "idle")


def make_result():
    spread = {"median": 0.05, "p99": 0.06, "p99.9": 0.07}
    run = {
        "latency_ms": {"p50": 0.3, "p99": 0.9, "p99.9": 2.0},
        "core": 0.02,
        "slices": 1000,
        "late": 0,
        "lost": 0,
        "backlog_ms": 0.0,
        "machine": {
            "latency_ms": {"p50": 0.1, "p99": 0.2, "p99.9": 0.3},
            "core": 0.01,
            "slices": 1000,
            "late": 0,
        },
    }
    played = {**run, "event_ms": {"mean": 0.7, "p99": 1.5, "p99.9": 4.0}}
    dense = {**run, "event_ms": {"mean": 0.9, "p99": 1.7, "p99.9": 4.0}}  # without a goal
    fast = {"median": 60e6, "p99": 50e6, "p99.9": 40e6}
    return {
        **{key: fast if key.endswith("per_s") else spread for key in STAGES},
        "tracker_ratio": 8.0,
        "realtime_factor": 20.0,
        "evaluate_factor": 50.0,
        "startup_s": {"help_cpu": 0.05, "reader_cpu": 0.1, "pad": 0.9},
        "rss_mb": 200.0,
        "events_per_s": 1e6,
        "live": {
            "device": "memory",
            **{load: {**run} for load in LOADS},
            "play": played,
            "at_12_million": dense,
        },
    }


def test_all_goals_are_reached():
    text = _format(make_result())
    assert "short" not in text
    assert text.count("OK") == 25


@pytest.mark.parametrize(
    ("load", "changes"),
    [
        ("at_1_khz", {"late": 1}),
        ("at_1_khz", {"core": 0.51}),
        ("at_250_hz", {"latency_ms": {"p50": 0.3, "p99": 1.6, "p99.9": 2.0}}),
        ("at_250_hz", {"core": 0.21}),
        ("at_12_million", {"lost": 1}),
        ("at_12_million", {"backlog_ms": 5.0}),
        ("at_12_million", {"latency_ms": {"p50": 0.4, "p99": 1.3, "p99.9": 2.0}}),
        ("play", {"event_ms": {"mean": 0.9, "p99": 1.5, "p99.9": 4.0}}),
        ("play", {"event_ms": {"mean": 0.7, "p99": 1.7, "p99.9": 4.0}}),
        ("idle", {"core": 0.04}),
    ],
)
def test_one_goal_that_is_missed_is_told(load, changes):
    result = make_result()
    result["live"][load] |= changes
    assert _format(result).count("short") == 1


def test_a_rate_has_a_least_and_a_time_a_most():
    result = make_result()
    result["tracker_events_per_s"] = {"median": 29e6, "p99": 1e6, "p99.9": 1e6}
    result["gesture_ms"] = {"median": 0.2, "p99": 0.9, "p99.9": 2.0}
    assert [line.split()[0] for line in _format(result).splitlines() if "short" in line] == [
        "tracker",
        "contacts,",
    ]


def test_what_the_machine_alone_makes_late_stands_beside():
    result = make_result()
    spread = {"p50": 0.11, "p99": 4.4, "p99.9": 9.0}
    alone = {"latency_ms": spread, "core": 0.077, "late": 7, "slices": 5_000}
    result["live"]["at_1_khz"]["machine"] = alone
    text = _format(result)
    assert "0 late and 0 lost of 1,000 slices (nothing to do: 7 late of 5,000)" in text
    assert "an empty pipeline" in text
    assert "4.400" in text
    assert ["of", "it", "the", "player", "7.700", "%"] in [row.split() for row in text.split("\n")]
