"""The events of a file against the same checks written with numpy."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.events import copy_events
from neurotouch_hid.messages import EVENT_DTYPE
from neurotouch_hid.recording.kernels.events import check_events

TOLERATED_US = 10_000


def _make(seed: int, n: int, *, spoiled: bool) -> np.ndarray:
    """Returns events that begin in the middle of a word, as they may in a packet."""
    rng = np.random.default_rng(seed)
    data = rng.integers(0, 256, 16 * n + 4, np.uint8)
    events = np.frombuffer(data, EVENT_DTYPE, n, 4)
    if not spoiled:
        events["t"] = 5_000 + np.cumsum(rng.integers(-300, 900, n))
        events["x"], events["y"] = rng.integers(0, 346, n), rng.integers(0, 260, n)
    return events


@given(seed=st.integers(0, 10_000), n=st.integers(1, 300), last_us=st.integers(-1, 40_000))
def test_they_ascend_and_are_ours(seed, n, last_us):
    given_ = _make(seed, n, spoiled=False)
    reached = np.maximum(np.maximum.accumulate(given_["t"]), last_us)
    back = np.flatnonzero(reached - given_["t"] > TOLERATED_US)
    events = copy_events(given_)
    outside, least, most, *step, last = check_events(
        events.view(np.int64), 346, 260, last_us, TOLERATED_US
    )
    assert (outside, least, most) == (False, given_["t"].min(), given_["t"].max())
    assert last == reached[-1]
    np.testing.assert_array_equal(events["t"], reached)
    first = back[:1]
    assert step == [*reached[first], *given_["t"][first]] or (not len(first) and step == [0, 0])
    ours = np.zeros(n, EVENT_DTYPE)
    ours["t"], ours["x"], ours["y"] = reached, given_["x"], given_["y"]
    ours["p"] = given_["p"].view(np.uint8) != 0
    assert events.tobytes() == ours.tobytes()


@given(seed=st.integers(0, 10_000), n=st.integers(1, 9), size=st.integers(2, 1 << 15))
def test_one_outside_of_the_sensor_is_found(seed, n, size):
    given_ = _make(seed, n, spoiled=True)
    outside = check_events(copy_events(given_).view(np.int64), size, 1 << 14, 0, TOLERATED_US)[0]
    x, y = given_["x"].view(np.uint16), given_["y"].view(np.uint16)
    assert outside == (x.max() >= size or y.max() >= 1 << 14)
