"""From words to events and frames: the vectors, every cut, malformed words, all orientations."""

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.source.davis.decoder import Decoder, DecoderStats
from neurotouch_hid.source.davis.kernels.decode import AddressLayout
from tests.reference.davis import PlainDecoder
from tests.source.davis.words import V1, V1_EVENTS, V2, V2_EVENTS, V3, V4, make_frame, pack

ALL = pack(" ".join([V1, V2, V3, V4]))


def decode(data, *, cuts=(), layout=None, synced=True):
    """Events as tuples, frames and counters of a stream that arrives in pieces."""
    decoder, events, frames = Decoder(layout, synced=synced), [], []
    for begin, end in zip([0, *cuts], [*cuts, len(data)], strict=True):
        found, pictures = decoder.decode(data[begin:end])
        events += [(int(t), int(x), int(y), bool(p)) for t, x, y, p in found]
        frames += [(f.pixels, f.exposure_begin_us, f.exposure_end_us) for f in pictures]
    return events, frames, decoder.stats()


def assert_same(one, other):
    assert one[0] == other[0]
    assert len(one[1]) == len(other[1])
    for frame, twin in zip(one[1], other[1], strict=True):
        assert np.array_equal(frame[0], twin[0])
        assert frame[1:] == twin[1:]
    assert one[2] == other[2]


def decode_plainly(data, layout=None, *, synced=True):
    plain = PlainDecoder(layout or AddressLayout(), synced)
    plain.feed(data)
    return plain.events, plain.frames, DecoderStats(**plain.count)


def test_events_and_time():
    assert decode(pack(V1)) == (V1_EVENTS, [], DecoderStats())


def test_malformed_words_are_counted_and_do_no_harm():
    events, frames, stats = decode(pack(V2))
    assert events == V2_EVENTS
    assert frames == []
    assert stats == DecoderStats(
        bad_rows=1, bad_columns=1, orphans=1, backward=1, unknown=4, resets=1
    )


@pytest.mark.parametrize("swap", [True, False])
def test_the_first_address_outside_is_no_event(swap):
    """The last inside is one; the next would be written beside the picture."""
    columns, rows = (260, 346) if swap else (346, 260)
    layout = AddressLayout(columns, rows, swap, swap)
    row, column = f"1{rows - 1:03X}", f"3{columns - 1:03X}"
    events, _, stats = decode(pack(f"83E8 {row} {column}"), layout=layout)
    assert (events, stats) == ([(1000, 345, 259, True)], DecoderStats())
    events, _, stats = decode(pack(f"83E8 {row} 3{columns:03X} 2{columns:03X}"), layout=layout)
    assert (events, stats) == ([], DecoderStats(bad_columns=2))
    events, _, stats = decode(pack(f"83E8 {row} 1{rows:03X} {column}"), layout=layout)
    assert (events, stats) == ([], DecoderStats(bad_rows=1, orphans=1))


def test_a_frame_lies_at_its_place():
    events, frames, stats = decode(pack(V3))
    assert (events, stats) == ([], DecoderStats())
    ((pixels, begin_us, end_us),) = frames
    assert (begin_us, end_us) == (1010, 1020)
    rows, columns = np.mgrid[:4, :8]
    difference = 8 * rows + columns
    assert np.array_equal(pixels[50:54, 100:108], -(-difference // 4))
    assert not pixels[:50].any()
    assert not pixels[:, 108:].any()


def test_light_that_pulls_the_reset_value_down_is_white():
    ((pixels, _, _),) = decode(pack(make_frame(reset=300)))[1]
    assert (pixels[50:54, 100:108] == 255).all()
    ((pixels, _, _),) = decode(pack(make_frame(signal=0)))[1]
    assert (pixels[50:54, 100:108] == 255).all()
    ((pixels, _, _),) = decode(pack(make_frame(signal=900)))[1]
    assert not pixels.any()


def test_the_inertial_unit_is_skipped():
    assert decode(pack(V4)) == ([], [], DecoderStats())


@pytest.mark.parametrize("cut", range(len(ALL) + 1))
def test_any_cut_gives_the_same(cut):
    assert_same(decode(ALL, cuts=[cut]), decode(ALL))


def test_byte_by_byte_gives_the_same():
    assert_same(decode(ALL, cuts=range(1, len(ALL))), decode(ALL))


@pytest.mark.parametrize("swap", [True, False])
@pytest.mark.parametrize("flips", [(False, False), (True, False), (False, True), (True, True)])
@pytest.mark.parametrize("mirrored", [False, True])
def test_every_orientation_is_as_the_twin_says(swap, flips, mirrored):
    columns, rows = (260, 346) if swap else (346, 260)
    layout = AddressLayout(columns, rows, swap, swap, *flips, mirrored=mirrored)
    data = pack(V3) if swap else _frame_without_swap()
    data += pack("1003 3004 2005")
    found = decode(data, layout=layout)
    assert_same(found, decode_plainly(data, layout))
    assert len(found[1]) == 1
    x, y = (3, 4) if swap else (4, 3)
    assert found[0][0] == (1030, 345 - x if mirrored else x, y, True)


def _frame_without_swap():
    """V3 for a chip whose columns are the picture's: 8 columns of 4."""
    words = make_frame().split()
    head = words[:13]
    columns = []
    for kind, value in (("000B", lambda c, r: 800), ("000C", lambda c, r: 800 - 4 * c - r)):
        for c in range(8):
            columns += [kind, *[f"{0x4000 | value(c, r):04X}" for r in range(4)], "000D"]
    return pack(" ".join([*head, *columns, "8406", "000A"]))


@pytest.mark.parametrize(
    ("spoil", "why"),
    [
        (lambda w: w[: w.index("000C")] + w[w.index("000C") + 10 :], "a column is missing"),
        (lambda w: w[: w.index("000C") + 1] + w[w.index("000C") + 2 :], "a sample is missing"),
        (lambda w: [*w[:-2], "4001", *w[-2:]], None),  # a sample outside a column is nobody's
        (lambda w: [*w[: w.index("000D")], "4001", *w[w.index("000D") :]], "a sample too many"),
        (lambda w: [*w[:-2], "000C", *["4001"] * 8, "000D", *w[-2:]], "a column too many"),
        (lambda w: [*w[:9], *w[11:]], "its region is not complete"),
        (lambda w: [*w[:5], "5101", "5280", *w[7:]], "its region is outside"),
        (lambda w: [*w[: w.index("000D")], *w[w.index("000D") + 1 :]], "a column has no end"),
        (lambda w: [*w[:13], *w[57:97], *w[13:57], *w[97:]], "signals come before resets"),
        (lambda w: w[:-1] + w, "it has no end before the next"),
        (lambda w: [*w[:-1], "0001", "000A"], "the clock begins anew in it"),
    ],
)
def test_a_frame_that_is_not_whole_is_dropped_and_counted(spoil, why):
    words = V3.split()
    data = pack(" ".join(spoil(words)))
    found = decode(data)
    assert_same(found, decode_plainly(data))
    assert found[2].bad_frames == (why is not None)
    assert_same(decode(data + pack(V3)), decode_plainly(data + pack(V3)))


def test_events_between_the_samples_of_a_frame():
    words = V3.split()
    at = words.index("4320") + 3
    mixed = [*words[:at], "83E9", "100A", "3014", *words[at:]]
    events, frames, stats = decode(pack(" ".join(mixed)))
    assert events == [(1001, 10, 20, True)]
    assert np.array_equal(frames[0][0], decode(pack(V3))[1][0][0])
    assert stats == DecoderStats()


def test_what_comes_before_the_clock_is_set_is_dropped():
    stale = pack("9000 1001 3001 7005 0008")
    assert decode(stale + pack("0001 " + V1), synced=False) == (V1_EVENTS, [], DecoderStats())
    assert decode(stale, synced=False)[0] == []


def test_time_goes_on_from_an_origin():
    decoder = Decoder(origin_us=5_000_000)
    events, _ = decoder.decode(pack("0001 8064 1001 3001"))
    assert events["t"].tolist() == [5_000_100]
    assert decoder.now_us == 5_000_100


def test_time_has_no_end():
    """2^31 µs, where libcaer's own time wraps, and far beyond."""
    events, _, stats = decode(pack(" ".join(["7FFF"] * 100) + " 8001 1001 3001"))
    assert events == [(100 * 0xFFF * 0x8000 + 1, 1, 1, True)]
    assert stats == DecoderStats()


def test_after_lost_bytes_nothing_is_put_to_a_row_of_before():
    decoder = Decoder(synced=True)
    decoder.decode(pack("8005 1001") + b"\x01")
    decoder.forget()
    events, _ = decoder.decode(pack("3001 1002 3003"))
    assert events[["t", "x", "y"]].tolist() == [(5, 2, 3)]
    assert decoder.stats().orphans == 1


@pytest.mark.parametrize(
    ("after", "t"),
    [
        ("8004 1001 3001", 32_772),  # the wrap was in what is missing
        ("8006 1001 3001", 6),
        ("1002 8006 1001 3001", 6),
        ("7001 8004 1001 3001", 32_772),
        ("1002 7002 8004 1001 3001", 65_540),
        ("8004 7001 8003 1001 3001", 65_539),
        ("0001 8004 1001 3001", 9),
    ],
)
def test_a_wrap_that_is_lost_does_not_let_time_stand_still(after, t):
    decoder = Decoder(synced=True)
    decoder.decode(pack("8005 1001"))
    decoder.forget()
    events, _ = decoder.decode(pack(after))
    assert events["t"].tolist() == [t]
    assert decoder.stats().backward == 0


def test_the_first_time_after_lost_bytes_may_come_later():
    decoder = Decoder(synced=True)
    decoder.decode(pack("8005 1001"))
    decoder.forget()
    decoder.decode(pack("1002 3002"))
    events, _ = decoder.decode(pack("8004 3003 8003 3004"))
    assert events["t"].tolist() == [32_772, 32_772]
    assert decoder.stats().backward == 1


words = st.one_of(
    st.integers(0, 0xFFFF),
    st.sampled_from([0x0001, 0x0008, 0x000A, 0x000B, 0x000C, 0x000D, 0x000E, 0x000F, 0x7001]),
    st.sampled_from([0x5100, 0x5200, 0x5201, 0x4320, 0x4100, 0x1003, 0x3004]),
)


@given(st.lists(words, max_size=200), st.lists(st.integers(0, 400), max_size=4), st.booleans())
def test_any_words_and_cuts_give_what_the_twin_gives(stream, cuts, synced):
    data = struct.pack(f"<{len(stream)}H", *stream)
    cuts = sorted(min(cut, len(data)) for cut in cuts)
    assert_same(decode(data, cuts=cuts, synced=synced), decode_plainly(data, synced=synced))


@given(st.lists(st.integers(0, 3), min_size=1, max_size=40), st.data())
def test_frames_of_one_pixel_in_pieces(kinds, data):
    """Small frames, whole and torn, between events: more frames in one piece than one."""
    small = make_frame((3, 4, 4, 4)).split()
    pieces = [small, small[:-3], ["1003", "3004"], ["0001"]]
    stream = pack(" ".join(word for kind in kinds for word in pieces[kind]))
    cut = data.draw(st.integers(0, len(stream)))
    assert_same(decode(stream, cuts=[cut]), decode_plainly(stream))
