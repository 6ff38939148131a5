"""``bench latency`` through a real event node; how long it takes is not judged in a slow guest."""

import pytest


@pytest.fixture(scope="module")
def seen(guest):
    return guest("latency")


@pytest.mark.parametrize("kind", ["uinput", "hid"])
def test_every_change_of_the_pad_arrives_and_is_timed(seen, kind):
    result = seen[kind]
    assert result["frames"] > 1  # a slow guest takes most of the time to find the gel
    for part in ("line", "device"):
        assert result[part]["n"] == result["frames"]
        assert sum(each["n"] for each in result[part]["histogram"]) == result["frames"]
        times = [result[part][f"{which}_ms"] for which in ("p50", "p99", "p999", "max")]
        assert times[0] > 0.0
        assert times == sorted(times)
    assert result["line"]["p50_ms"] > result["device"]["p50_ms"]


def test_readers_get_the_sensors_time_where_the_kernel_honours_it(seen):
    version = tuple(map(int, seen["kernel"].split("-")[0].split(".")[:2]))
    if version >= (6, 8):
        assert seen["uinput"]["sensor_time_kept"] > 0.5
    else:
        assert seen["uinput"]["sensor_time_kept"] < 0.5
    assert seen["hid"]["sensor_time_kept"] < 0.5  # HID reports carry no time
