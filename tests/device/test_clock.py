"""Sensor time on the kernel's clock: regular, never back, never in the future."""

from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.device.outputs.clock import SensorClock

MS = 1_000_000


class Host:
    """A clock that is moved by hand."""

    def __init__(self) -> None:
        self.ns = 1_000_000 * MS

    def now(self) -> int:
        return self.ns


def stamp_all(*late_ms: float) -> list[float]:
    """The stamps of states every 10 ms that come so late, in ms since the first was due."""
    host = Host()
    clock = SensorClock(host.now)
    begin = host.ns
    stamps = []
    for number, late in enumerate(late_ms):
        host.ns = begin + 10 * number * MS + round(late * MS)
        stamps.append((clock.stamp(5_000_000 + 10_000 * number) - begin) / MS)
    return stamps


def test_a_late_state_has_the_stamp_of_its_moment():
    assert stamp_all(1, 1, 4, 1, 9, 1) == [1, 11, 21, 31, 41, 51]


def test_the_least_delay_is_the_offset():
    assert stamp_all(5, 1, 3, 1) == [5, 11, 21, 31]


def test_a_state_without_newer_sensor_time_is_stamped_now():
    host = Host()
    clock = SensorClock(host.now)
    clock.stamp(1_000)
    host.ns += 7 * MS
    assert clock.stamp(1_000) == host.ns


def test_what_no_sensor_has_seen_is_now_and_nothing_comes_before_it():
    host = Host()
    clock = SensorClock(host.now)
    clock.stamp(1_000)
    host.ns += 15 * MS
    assert clock.now() == host.ns
    assert clock.stamp(11_000) == host.ns


def test_another_recording_begins_anew():
    host = Host()
    clock = SensorClock(host.now)
    clock.stamp(9_000_000_000)
    host.ns += 10 * MS
    assert clock.stamp(0) == host.ns
    host.ns += 12 * MS
    assert clock.stamp(10_000) == host.ns  # its own offset, not the old one


def test_a_stamp_of_long_ago_is_now():
    host = Host()
    clock = SensorClock(host.now)
    clock.stamp(0)
    host.ns += 5_000 * MS
    assert clock.stamp(10_000) == host.ns


def test_the_offset_follows_a_clock_that_drifts():
    host = Host()
    clock = SensorClock(host.now)
    worst = 0
    for number in range(1, 2_000):  # 20 s in which the sensor's clock loses 1 ms a second
        host.ns += 10 * MS + 10_000
        worst = max(worst, host.ns - clock.stamp(10_000 * number))
    assert worst <= 5 * MS  # of 20 ms that it has lost


@given(st.lists(st.tuples(st.integers(0, 50_000), st.integers(0, 3_000 * MS)), max_size=60))
def test_stamps_never_go_back_and_never_lie_ahead(turns):
    host = Host()
    clock = SensorClock(host.now)
    t_us, last = 0, 0
    for step_us, host_ns in turns:
        t_us += step_us
        host.ns += host_ns
        stamp = clock.stamp(t_us)
        assert last <= stamp <= host.ns
        assert host.ns - stamp <= 3_100 * MS  # the kernel takes what is at most 10 s old
        last = stamp
