"""Slices do not depend on how the stream was cut into batches; every event comes out once."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import EVENT_DTYPE, Frame
from neurotouch_hid.source.slicer import MAX_SILENCE_US, Slicer, slice_recording

PIXELS = np.zeros((260, 346), np.uint8)
SLICE_US = 100


def events_at(stamps):
    events = np.zeros(len(stamps), EVENT_DTYPE)
    events["t"] = stamps
    events["x"] = np.arange(len(stamps)) % 346
    return events


def plain_slices(stamps, frame_ends, slice_us):
    """Begin, event stamps and frame ends of each slice, slowly: the twin of the slicer."""
    begin = min([*stamps, *frame_ends])
    last = max([*stamps, *frame_ends])
    slices = []
    while begin <= last:
        end = begin + slice_us
        inside = [t for t in stamps if begin <= t < end]
        taken = [t for t in frame_ends if begin <= t < end]
        slices.append((begin, inside, taken))
        begin = end
        later = [t for t in [*stamps, *frame_ends] if t >= begin]
        if later and min(later) - begin > MAX_SILENCE_US:
            begin += (min(later) - begin) // slice_us * slice_us
    return slices


def batches_of(stamps, frame_ends, cuts):
    """The stream cut at these places; a frame comes with the first batch that reaches its end."""
    edges = sorted({0, len(stamps), *(cut % (len(stamps) + 1) for cut in cuts)})
    waiting = sorted(frame_ends)
    batches = []
    for low, high in pairwise(edges):
        part = stamps[low:high]
        frames = tuple(Frame(PIXELS, t - 3, t) for t in waiting if t <= part[-1])
        waiting = [t for t in waiting if t > part[-1]]
        batches.append((events_at(part), frames))
    batches.append((events_at([]), tuple(Frame(PIXELS, t - 3, t) for t in waiting)))
    return batches


origins = st.sampled_from([0, -5_000, 1_589_163_147_368_868, -(2**61), 2**61])
steps = st.lists(
    st.one_of(st.integers(0, 30), st.integers(0, 500), st.just(3 * MAX_SILENCE_US)),
    min_size=1,
    max_size=60,
)


@given(origins, steps, st.lists(st.integers(0, 3_000), max_size=5), st.lists(st.integers(0, 100)))
def test_any_batching_gives_the_same_slices(origin, gaps, frame_offsets, cuts):
    stamps = [origin + int(t) for t in np.cumsum(gaps)]
    frame_ends = [stamps[0] + offset for offset in frame_offsets]
    packets = list(slice_recording(batches_of(stamps, frame_ends, cuts), SLICE_US))
    expected = plain_slices(stamps, sorted(frame_ends), SLICE_US)
    assert [
        (p.t_begin_us, p.events["t"].tolist(), [f.exposure_end_us for f in p.frames])
        for p in packets
    ] == expected
    assert all(p.t_end_us - p.t_begin_us == SLICE_US for p in packets)
    assert all(p.events.dtype == EVENT_DTYPE for p in packets)


@given(
    origins,
    st.lists(st.integers(0, 200), min_size=1, max_size=60),
    st.lists(st.sampled_from([None, 20, 33, 100, 500]), min_size=1),
    st.lists(st.integers(0, 100)),
)
def test_slices_in_parts_keep_the_grid_and_every_event(origin, gaps, parts, cuts):
    stamps = [origin + int(t) for t in np.cumsum(gaps)]
    slicer, packets = Slicer(SLICE_US, origin), []
    for events, _ in batches_of(stamps, [], cuts):
        for packet in slicer.push(events):
            packets.append(packet)
            slicer.part_us = parts[len(packets) % len(parts)]
    packets += slicer.flush()
    assert [t for p in packets for t in p.events["t"].tolist()] == stamps
    part_us = None
    for k, packet in enumerate(packets):
        t = packet.events["t"]
        assert ((packet.t_begin_us <= t) & (t < packet.t_end_us)).all()
        left_us = SLICE_US - (packet.t_begin_us - origin) % SLICE_US
        assert packet.t_end_us - packet.t_begin_us == min(part_us or left_us, left_us)
        assert k == 0 or packet.t_begin_us == packets[k - 1].t_end_us
        part_us = parts[(k + 1) % len(parts)]


@pytest.mark.parametrize("n", [1, 5, 40])
def test_all_slices_before_a_break_come_first(n):
    whole = [(events_at([t, t + 40]), ()) for t in range(0, n * SLICE_US, SLICE_US)]

    def broken():
        yield from whole
        raise RecordingError("cut off")

    packets = []
    with pytest.raises(RecordingError, match="cut off"):
        packets.extend(slice_recording(broken(), SLICE_US))
    assert [p.events["t"].tolist() for p in packets] == [e["t"].tolist() for e, _ in whole]


@pytest.mark.parametrize(("n_events", "n_ahead"), [(1, 17), (1 << 15, 2), (1 << 18, 2)])
def test_only_a_little_of_a_recording_is_read_ahead(n_events, n_ahead):
    taken = []

    def batches():
        for t in range(0, 100 * SLICE_US, SLICE_US):
            taken.append(t)
            yield events_at([t] * n_events), ()

    next(slice_recording(batches(), SLICE_US))
    assert len(taken) == n_ahead


def test_hours_of_silence_are_skipped_on_the_same_grid():
    hour_us = 3_600_000_000
    packets = list(slice_recording([(events_at([5, 7 * hour_us]), ())], 10_000))
    assert len(packets) == 2
    assert (packets[1].t_begin_us - packets[0].t_begin_us) % 10_000 == 0
    assert packets[1].t_begin_us <= 7 * hour_us < packets[1].t_end_us


def test_a_late_frame_goes_into_the_next_slice():
    slicer = Slicer(SLICE_US)
    done = list(slicer.push(events_at([0, 50, 250])))
    assert [len(packet.frames) for packet in done] == [0, 0]
    done = list(slicer.push(events_at([300]), [Frame(PIXELS, 10, 20)]))
    assert [len(packet.frames) for packet in done] == [1]


def test_a_partial_slice_can_be_taken_and_changes_nothing():
    slicer = Slicer(SLICE_US)
    assert slicer.partial(10, 100) is None
    assert list(slicer.push(events_at([0, 20]))) == []
    assert list(slicer.push(events_at([40, 60, 60]), [Frame(PIXELS, 10, 30)])) == []
    partial = slicer.partial(60, 5)
    assert (partial.t_begin_us, partial.t_end_us, partial.is_partial) == (0, 60, True)
    assert partial.events["t"].tolist() == [0, 20, 40]  # another event at 60 may still come
    assert partial.frames == ()
    assert slicer.partial(60, 4) is None
    assert slicer.partial(SLICE_US, 100) is None
    (whole,) = slicer.push(events_at([SLICE_US + 50]))
    assert not whole.is_partial
    assert whole.events["t"].tolist() == [0, 20, 40, 60, 60]
    assert len(whole.frames) == 1


def test_a_slice_within_a_batch_is_a_view():
    events = events_at(range(0, 1000, 10))
    packets = list(slice_recording([(events, ())], SLICE_US))
    assert all(np.shares_memory(packet.events, events) for packet in packets)


def test_nothing_gives_nothing():
    assert list(slice_recording([], SLICE_US)) == []
    with pytest.raises(ValueError, match="at least 1"):
        Slicer(0)
