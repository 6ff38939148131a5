"""The camera's stream: random words, real ones, and real ones with bytes missing, wrong or moved.

The first byte of a case says what is right: that the stream is believed, refused, or either.
"""

import random
import struct
import threading
from collections.abc import Callable, Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Final, cast

import numpy as np
from neurotouch_devtools.emulator import registers as reg

from neurotouch_hid.evaluation.speed.workload import load_scene
from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, EventPacket
from neurotouch_hid.process.kernel_cache import bind
from neurotouch_hid.source.davis.camera import Camera
from neurotouch_hid.source.davis.config import DavisConfig
from neurotouch_hid.source.davis.decoder import Decoder, DecoderStats
from neurotouch_hid.source.davis.kernels.decode import AddressLayout, decode
from neurotouch_hid.source.davis.stream import Stream
from neurotouch_hid.source.davis.stream_check import OutOfStepError
from tests.fuzz.area import Area
from tests.reference.davis import PlainDecoder
from tests.source.davis.cable import emulate
from tests.source.davis.words import make_frame, pack

EITHER, BELIEVED, REFUSED = range(3)
_CLOCK_RESET: Final = b"\x01\x00"
_MOST_FOR_TWIN: Final = 40_000
"""Bytes; the twin is plain, and slow."""
_MIN_DENSE, _MIN_SPARSE = 30_000, 2_000
"""Bytes out of step after which a stream with frames, and one without, must have been refused."""
_GUARD: Final = 4
_SLICE_US: Final = 10_000
_WORDS: Final = (
    *(0x0001, 0x0008, 0x0009, 0x000A, 0x000B, 0x000C, 0x000D, 0x000E, 0x000F, 0x7001, 0x7000),
    *(0x5100, 0x5101, 0x5200, 0x5201, 0x5259, 0x5203, 0x4320, 0x4100, 0x4000, 0x43FF),
    *(0x1003, 0x1159, 0x115A, 0x1104, 0x3004, 0x2103, 0x3104, 0x3159, 0x8001, 0xFFFF, 0x7FFF),
)


@cache
def _real(with_frames: bool) -> bytes:
    """Returns a quarter of a second of a push, seen by the emulated camera."""
    now = [0]
    camera = emulate(load_scene("push", _SLICE_US, 1_600_000).packets, clock_ns=lambda: now[0])
    switches = (reg.CHIP_RUN, reg.USB_RUN, reg.TIMESTAMP_RUN, reg.MUX_RUN, reg.DVS_RUN)
    for switch in (*switches, *([reg.APS_RUN] if with_frames else [])):
        camera.write(switch, 1)
    camera.write(reg.EARLY_PACKET_DELAY, 1)
    found = b""
    for ms in range(1_550):
        now[0] = 1_000_000 * ms
        while (data := camera.read(8_192)) is not None:
            found += data if ms >= 1_300 else b""
    return found


def make(chance: random.Random) -> bytes:
    """Returns what is right, and a stream."""
    return chance.choice(_KINDS)(chance)


def _random_words(chance: random.Random) -> bytes:
    return bytes([EITHER]) + chance.randbytes(chance.choice((0, 1, 2, 7, 100, 1_000, 4_001)))


def _chosen_words(chance: random.Random) -> bytes:
    """Words with a meaning, whole and torn frames between them."""
    stream = b""
    for _ in range(chance.choice((1, 5, 30))):
        x, y = chance.choice((0, 342, 345, chance.randrange(342))), chance.choice((0, 256, 259))
        frame = pack(
            make_frame((x, y, min(345, x + chance.randrange(6)), min(259, y + chance.randrange(6))))
        )
        while chance.random() < 0.5:
            frame = _slip(frame, chance)
        n = chance.randrange(60)
        words = (chance.choice((*_WORDS, chance.randrange(1 << 16))) for _ in range(n))
        stream += frame + struct.pack(f"<{n}H", *words)
    return bytes([EITHER]) + stream


def _whole_words(chance: random.Random) -> bytes:
    """Real words, some of them lost as in a lost transfer."""
    stream, _ = _cut_real(chance)
    for _ in range(chance.choice((0, 0, 1, 3))):
        at = 2 * chance.randint(0, len(stream) // 2)
        stream = stream[:at] + stream[at + 2 * chance.choice((1, 2, 17, 1_024, 4_096)) :]
    return bytes([BELIEVED]) + stream


def _out_of_step(chance: random.Random) -> bytes:
    """Real words, of which bytes are lost or come in addition, an odd number."""
    stream, least = _cut_real(chance)
    at = chance.randrange(len(stream))
    n = chance.choice((1, 1, 1, 3, 5, 511, 1_023, 8_191))
    if chance.random() < 0.5:
        before, after = stream[:at], stream[at + n :]
    else:
        before, after = stream[:at] + chance.randbytes(n), stream[at:]
    right = REFUSED if len(after) > least else EITHER
    return bytes([right]) + before + after


def _damaged(chance: random.Random) -> bytes:
    stream, _ = _cut_real(chance)
    for _ in range(chance.choice((1, 1, 2, 5, 40))):
        stream = _slip(stream, chance)
    return bytes([EITHER]) + stream


_KINDS: Final = (_random_words, _chosen_words, _whole_words, _out_of_step, _damaged)


def _cut_real(chance: random.Random) -> tuple[bytes, int]:
    """Returns a part of a real stream, and the least that tells it from one out of step."""
    with_frames = chance.random() < 0.5
    stream = _real(with_frames)
    length = 2 * chance.choice((10, 100, 1_000, 8_000, 40_000))
    begin = 2 * chance.randrange(max(1, (len(stream) - length) // 2))
    return stream[begin : begin + length], _MIN_DENSE if with_frames else _MIN_SPARSE


def _slip(stream: bytes, chance: random.Random) -> bytes:
    if not stream:
        return stream
    data, at = bytearray(stream), chance.randrange(len(stream))
    match chance.randrange(6):
        case 0:
            del data[at:]
        case 1:
            del data[at : at + chance.choice((1, 2, 3, 100, 2_000))]
        case 2:
            data[at:at] = chance.randbytes(chance.choice((1, 2, 3, 100)))
        case 3:
            other = chance.randrange(len(data)) & ~1
            data[at & ~1 : at & ~1] = data[other : other + chance.choice((1, 2, 40, 200, 2_000))]
        case _:
            data[at] ^= 1 << chance.randrange(8)
    return bytes(data)


def check(path: Path) -> None:
    """Decodes a stream, and plays it as the driver does.

    Raises:
        OutOfStepError: the driver refuses it, rightly.
        AssertionError: anything else is wrong.
    """
    right, data = path.read_bytes()[0], _CLOCK_RESET + path.read_bytes()[1:]
    chance = random.Random(data)
    layout = _choose_layout(chance) if right == EITHER else AddressLayout()
    chunks = list(_cut(data, chance))
    _check_decoder(data, chunks, layout)
    try:
        _play(chunks, layout, len(data) // 2)
    except OutOfStepError:
        assert right != BELIEVED, "a sound stream is refused"
        raise
    assert right != REFUSED, "a stream out of step is believed"


def _choose_layout(chance: random.Random) -> AddressLayout:
    swap = chance.random() < 0.5
    size = (SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX)
    flips = (chance.random() < 0.5 for _ in range(3))
    return AddressLayout(*(size if swap else size[::-1]), swap, swap, *flips)


def _cut(data: bytes, chance: random.Random) -> Iterator[bytes]:
    at, size = 0, chance.choice((64, 1_024, 8_192))
    while at < len(data):
        n = chance.randint(1, size)
        yield data[at : at + n]
        at += n


def _check_decoder(data: bytes, chunks: list[bytes], layout: AddressLayout) -> None:
    """Decodes it between guards; all that comes out is inside, in order and as the twin says."""
    decoder = Decoder(layout)
    guards = _guard(decoder, len(data))
    found, frames, last_us = [], [], 0
    for chunk in chunks:
        events, pictures = decoder.decode(chunk)
        assert len(events) <= len(chunk) // 2 + 1, "events out of nothing"
        last_us = _check_events(events, last_us)
        found += events.tolist() if len(data) <= _MOST_FOR_TWIN else []
        frames += pictures
        assert decoder.now_us >= last_us, "an event of the future"
    for guarded, before in guards:
        assert (guarded == before).all(), "written out of bounds"
    assert len(frames) <= len(data) // 20, "frames out of nothing"
    if len(data) > _MOST_FOR_TWIN:
        return
    twin = PlainDecoder(layout)
    twin.feed(data[: len(data) & ~1])
    assert found == twin.events, "other events than the twin's"
    assert decoder.stats() == DecoderStats(**twin.count), "other counts than the twin's"
    assert len(frames) == len(twin.frames), "other frames than the twin's"
    for frame, (pixels, begin_us, end_us) in zip(frames, twin.frames, strict=True):
        assert (frame.exposure_begin_us, frame.exposure_end_us) == (begin_us, end_us)
        assert np.array_equal(frame.pixels, pixels), "another picture than the twin's"


def _guard(decoder: Decoder, n: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Puts the decoder's arrays between guards; returns those, and what is to stay in them."""
    guards, inner = [], []
    for dtype in (np.int16, np.uint8):  # the reset values, and the picture
        around = np.full((SENSOR_HEIGHT_PX + 2 * _GUARD, SENSOR_WIDTH_PX), 77, dtype)
        around[_GUARD:-_GUARD] = 0
        inner.append(around[_GUARD:-_GUARD])
        guards += [(side, side.copy()) for side in (around[:_GUARD], around[-_GUARD:])]
    decoder._pixels = inner[1]
    decoder._decode = bind(decode, decoder._layout, decoder._state, decoder._counters, *inner)
    events = np.zeros(n + 2 * _GUARD, EVENT_DTYPE)
    decoder._events = events[_GUARD:-_GUARD]
    return guards + [(side, side.copy()) for side in (events[:_GUARD], events[-_GUARD:])]


def _check_events(events: np.ndarray, last_us: int) -> int:
    if not len(events):
        return last_us
    t = events["t"]
    assert t[0] >= last_us, "time goes back"
    assert (t[1:] >= t[:-1]).all(), "time goes back"
    assert events["x"].max() < SENSOR_WIDTH_PX, "x"
    assert events["y"].max() < SENSOR_HEIGHT_PX, "y"
    assert events["p"].view(np.uint8).max() <= 1, "p"
    return int(t[-1])


def _play(chunks: list[bytes], layout: AddressLayout, n_words: int) -> None:
    """Plays it as the driver does, on one grid of slices and with a clock that is believed.

    Raises:
        OutOfStepError: the driver refuses it.
    """
    packets: list[EventPacket] = []
    closing = threading.Event()
    camera = cast(Camera, _Scripted(chunks, layout, closing.set))
    stream = Stream(camera, DavisConfig(), _SLICE_US, packets.append, lambda: None)
    try:
        stream.run(closing)
    finally:
        whole = [packet for packet in packets if not packet.is_partial]
        for packet in packets:
            assert packet.t_begin_us % _SLICE_US == 0, "off the grid"
            events = packet.events
            assert not len(events) or packet.t_begin_us <= events["t"][0], "too early"
            assert not len(events) or events["t"][-1] < packet.t_end_us, "too late"
        assert all(b.t_begin_us >= a.t_end_us for a, b in pairwise(whole)), "slices overlap"
        assert sum(len(packet.events) for packet in whole) <= n_words, "events out of nothing"
        believed_us = 1_000_000 * (len(chunks) + 3)
        assert all(packet.t_end_us < believed_us for packet in whole), "a wrong clock is believed"


class _Scripted(SimpleNamespace):
    """A camera that has been set up, sends its chunks and is closed then."""

    def __init__(
        self, chunks: list[bytes], layout: AddressLayout, close: Callable[[], None]
    ) -> None:
        super().__init__(layout=layout, is_colour=False, transport=self, count_dropped=lambda: 0)
        self._chunks, self._close = iter(chunks), close

    def start(self, config: DavisConfig, receive: Callable[[bytes], Any]) -> None:
        self._receive = receive

    def pump(self, *_: float) -> None:
        chunk = next(self._chunks, b"")
        if chunk:
            self._receive(chunk)
        else:
            self._close()


CAMERA_WORDS: Final = Area(make, check, OutOfStepError, ".words")
