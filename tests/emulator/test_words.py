"""Events and frames as words: the published vectors, the plain twin, a host that listens."""

from collections import deque

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from neurotouch_devtools.emulator.kernels.encode import encode_words
from neurotouch_devtools.emulator.readout import Readout, Region, read_out
from neurotouch_devtools.emulator.words import WordEncoder

from neurotouch_hid.messages import EVENT_DTYPE, Frame
from tests.emulator.listener import Listener
from tests.reference.emulator import PlainEncoder


def make_events(rows):
    return np.array(rows, EVENT_DTYPE)


def encode(encoder, events, readouts=(), until_us=1 << 40, shift_us=0):
    return encoder.encode(events, deque(readouts), until_us=until_us, shift_us=shift_us)


def to_hex(words):
    return " ".join(f"{word:04X}" for word in words)


@pytest.mark.parametrize("n", [1, 2, 50])
def test_nothing_is_compiled_once_it_is_made(n):
    encoder = WordEncoder(swap=True)
    n_before = encode_words.n_variants
    events = make_events([(k, 1, 2, 1) for k in range(n)])
    events.flags.writeable = False
    readout = read_out(
        Frame(np.zeros((260, 346), np.uint8), 2000, 6000),
        Region(0, 0, 9, 9),
        orientation=4,
        exposure_cycles=1,
        begin_us=0,
    )
    encode(encoder, events, [readout])
    assert encode_words.n_variants == n_before == 1


def test_the_published_events_become_the_published_words():
    events = make_events(
        [
            (1000, 10, 20, 1),
            (1000, 10, 21, 0),
            (1000, 345, 259, 1),
            (1007, 0, 0, 0),
            (32768, 1, 1, 1),
            (32773, 2, 2, 0),
            (163839, 3, 3, 1),
        ]
    )
    assert to_hex(encode(WordEncoder(swap=True), events)) == (
        "83E8 100A 3014 2015 1159 3103 83EF 1000 2000 7001 1001 3001 8005 1002 2002 7003 FFFF "
        "1003 3003"
    )


def test_without_swap_the_row_word_carries_y():
    words = encode(WordEncoder(swap=False), make_events([(5, 345, 20, 1)]))
    assert to_hex(words) == "8005 1014 3159"


def test_the_published_frame_has_the_published_frame_s_form():
    frame = Frame(np.zeros((260, 346), np.uint8), 1010, 1020)
    readout = read_out(
        frame, Region(100, 50, 107, 53), orientation=4, exposure_cycles=604800, begin_us=1000
    )
    words = to_hex(encode(WordEncoder(swap=True), make_events([]), [readout])).split()
    assert " ".join(words[:13]) == (
        "83E8 0008 6280 624E 6000 5100 5264 5100 5232 5100 526B 5100 5235"
    )
    columns = ["000B", *8 * ["4"], "000D"] * 4 + ["83F2", "000E", "83FC", "000F"]
    columns += ["000C", *8 * ["4"], "000D"] * 4
    assert [word[0] if word[0] == "4" else word for word in words[13:-2]] == columns
    assert words[-1] == "000A"


@given(
    st.lists(
        st.tuples(st.integers(0, 200_000), st.integers(0, 345), st.integers(0, 259), st.booleans()),
        max_size=30,
    ),
    st.lists(st.tuples(st.integers(0, 200_000), st.booleans()), max_size=8),
    st.lists(st.integers(0, 200_001), max_size=4),
    st.integers(0, 1 << 33),
)
def test_the_kernel_does_what_its_plain_twin_does(rows, runs, stops, shift_us):
    rows, runs = sorted(rows), sorted(runs)
    events = make_events(rows)
    contents = [[0x4000 + k] * (1 + k % 3) for k in range(len(runs))]
    readout = Readout(
        np.array([t for t, _ in runs], np.int64),
        np.cumsum([len(words) for words in contents], dtype=np.int64),
        np.array([dated for _, dated in runs], np.bool_),
        np.array([word for words in contents for word in words], np.uint16),
    )
    encoder, plain = WordEncoder(swap=True), PlainEncoder()
    readouts = deque([readout] if runs else [])
    done = 0
    for until_us in [*sorted(stops), 300_000]:
        words = encoder.encode(
            events[(events["t"] >= done) & (events["t"] < until_us)],
            readouts,
            until_us=until_us,
            shift_us=shift_us,
        )
        expected = plain.encode(
            [(t + shift_us, x, y, on) for t, x, y, on in rows if t >= done],
            [(t + shift_us, dated, contents[k]) for k, (t, dated) in enumerate(runs) if t >= done],
            until_us + shift_us,
        )
        assert words.tolist() == expected
        done = max(done, until_us)
    assert not readouts


@given(st.integers(0, 7), st.integers(0, 2**32 - 1))
def test_a_host_hears_what_was_shown(orientation, seed):
    rng = np.random.default_rng(seed)
    x0, x1 = sorted(rng.integers(0, 346, 2).tolist())
    y0, y1 = sorted(rng.integers(0, 260, 2).tolist())
    x1, y1 = min(x1, x0 + 30), min(y1, y0 + 30)
    n = 300
    events = np.zeros(n, EVENT_DTYPE)
    events["t"] = np.sort(rng.integers(900, 100_000, n))
    events["x"], events["y"] = rng.integers(0, 346, n), rng.integers(0, 260, n)
    events["p"] = rng.integers(0, 2, n)
    frame = Frame(rng.integers(0, 256, (260, 346)).astype(np.uint8), 31_000, 35_000)
    readout = read_out(
        frame,
        Region(x0, y0, x1, y1),
        orientation=orientation,
        exposure_cycles=120_960,
        begin_us=30_000,
        global_shutter=bool(seed % 2),
    )
    encoder = WordEncoder(swap=bool(orientation & 4))
    heard = Listener(orientation)
    heard.hear(encoder.reset().tobytes())
    heard.hear(encode(encoder, events, [readout]).tobytes())
    assert heard.events == [(t, x, y, bool(on)) for t, x, y, on in events.tolist()]
    assert heard.resets == 1
    (seen,) = heard.frames
    shown = frame.pixels[y0 : y1 + 1, x0 : x1 + 1].astype(int)
    assert np.array_equal(np.ceil(seen["picture"] / 4), shown)  # dv-processing
    assert np.array_equal(seen["picture"] >> 2, shown)
    assert seen["roi"] == [x0, y0, x1, y1]
    assert seen["global"] == bool(seed % 2)
    assert seen["cycles"] == 120_960
    assert (seen["begin"], seen["exposure_begin"], seen["exposure_end"]) == (30_000, 31_000, 35_000)
    assert seen["end"] > 35_000


def test_wraps_come_one_by_one_in_a_quiet_camera():
    encoder = WordEncoder(swap=True)
    words = [encoder.wrap(t_us).tolist() for t_us in (0, 32_767, 32_768, 65_000, 65_536, 65_537)]
    assert words == [[], [], [0x7001], [], [0x7001], []]


def test_held_back_wraps_come_as_one():
    assert WordEncoder(swap=True).wrap(10 * 32_768 + 5).tolist() == [0x700A]


def test_what_was_held_back_is_never_dated_back():
    encoder = WordEncoder(swap=True)
    encode(encoder, make_events([(1000, 1, 1, 1)]))
    late = Readout(np.array([500]), np.array([1]), np.array([True]), np.array([0xA], np.uint16))
    assert encode(encoder, make_events([]), [late]).tolist() == [0x000A]


def test_a_white_and_a_black_pixel_survive():
    frame = Frame(np.array([[0, 255]], np.uint8).repeat(260, 0).repeat(173, 1), 10_000, 14_000)
    readout = read_out(frame, Region(0, 0, 345, 259), orientation=4, exposure_cycles=1, begin_us=0)
    heard = Listener().hear(encode(WordEncoder(swap=True), make_events([]), [readout]).tobytes())
    assert np.array_equal(heard.frames[0]["picture"] >> 2, frame.pixels)


@pytest.mark.parametrize("length", [0, 40_000])
def test_many_events_at_once(length):
    events = np.zeros(length, EVENT_DTYPE)
    events["t"] = np.arange(length) * 7
    events["x"] = np.arange(length) % 346
    heard = Listener().hear(encode(WordEncoder(swap=True), events).tobytes())
    assert [event[:2] for event in heard.events] == [(7 * k, k % 346) for k in range(length)]
