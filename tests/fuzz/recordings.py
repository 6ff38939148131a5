"""Recordings, damaged outside and inside their compression.

A case begins as lists of packets, each a FlatBuffer. Changes are made to those, to their order, to
the header and its text; then all is compressed and framed, and what comes out is changed once more.
"""

import random
import struct
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

import lz4.frame
import numpy as np

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, Frame
from neurotouch_hid.recording import Recording, packing
from neurotouch_hid.recording.compression import LZ4, LZ4_HIGH, NONE, ZSTD, ZSTD_HIGH
from neurotouch_hid.recording.header import MAGIC
from neurotouch_hid.source.replay import Replay
from tests.fuzz.area import Area
from tests.recording.streams import make_events

_TEXT_AT: Final = len(MAGIC) + packing._HEADER.size
_COMPRESSION_AT: Final = len(MAGIC) + 4 + 28
_NUMBERS: Final = (0, 1, 2, 7, 16, 255, 346, 1000, 65535, 0x7FFFFFFF, 1 << 40, 1 << 62, -1, -16)
_WORDS: Final = (b"", b"<", b">", b"EVTS", b"FRME", b"IMUS", b"0", b"1", b"346", b"-1", b"9" * 30)
_MARKUP: Final = (
    *(b"<!DOCTYPE a [<!ENTITY b 'c'>]>", b"&b;", b"&#0;", b"<?xml version='1.0' encoding='x'?>"),
    *(b"<a>" * 500, b"</node>", b"\xff", b"\xed\xa0\x80", b"<node name='7'>", b"]]>"),
)


@dataclass(slots=True)
class _Draft:
    """A recording before it is written.

    Attributes:
        header: up to the first packet.
        packets: stream and FlatBuffer of each, its size in front.
        compression: how they are written.
    """

    header: bytearray
    packets: list[tuple[int, bytes]]
    compression: int


@cache
def _parts() -> tuple[list[tuple[int, bytes]], ...]:
    """Returns short recordings; most bytes of a case are the same as in the one before."""
    black = np.zeros((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), np.uint8)
    events = [
        (0, _inside(packing.pack_events(make_events(n, 10_000, n, 1_000_000 + 10_000 * i))))
        for i, n in enumerate((1, 40, 300, 2, 900, 17))
    ]
    frames = [
        (1, _inside(packing.pack_frame(Frame(black, 1_000_000 + t_us, 1_004_000 + t_us))))
        for t_us in (3_000, 33_000)
    ]
    return events, [events[0], frames[0], *events[1:4], frames[1], *events[4:]], frames, [events[2]]


def _inside(packet: bytes) -> bytes:
    return bytes(lz4.frame.decompress(packet[8:]))


def _change_bytes(data: bytearray, chance: random.Random) -> None:
    """Changes a few bytes, most of them near the beginning."""
    if not data:
        return
    for _ in range(chance.choice((1, 1, 1, 2, 5))):
        reach = len(data) if chance.random() < 0.4 else min(len(data), 90)
        at = chance.randrange(reach)
        kind = chance.choice("Bbit<h<i<q")
        match kind:
            case "<" | "h" | "i" | "q":
                size = {"<": 1, "h": 2, "i": 4, "q": 8}[kind]
                number = chance.choice(_NUMBERS) & ((1 << 8 * size) - 1)
                data[at : at + size] = number.to_bytes(size, "little")
            case "B":
                data[at] = chance.randrange(256)
            case _:
                data[at] ^= 1 << chance.randrange(8)


def _change_packet(data: bytes, chance: random.Random) -> bytes:
    changed = bytearray(data)
    match chance.randrange(8):
        case 0:
            del changed[chance.randint(0, len(changed)) :]
        case 1:
            changed += chance.randbytes(chance.choice((1, 4, 100)))
        case 2:
            at = chance.randint(0, len(changed))
            del changed[at : at + chance.choice((1, 4, 16, 1000))]
        case 3:  # the size in front is right again
            changed = changed[: chance.randint(4, max(4, len(changed)))]
            _change_bytes(changed, chance)
        case 4:  # one stamp
            at = 32 + 16 * chance.randrange(max(1, (len(changed) - 32) // 16))
            stamp = chance.choice((*_NUMBERS, 1_000_000 + chance.randint(-30_000, 30_000)))
            changed[at : at + 8] = struct.pack("<q", stamp)
        case _:
            _change_bytes(changed, chance)
    if chance.random() < 0.5 and len(changed) >= 4:
        changed[:4] = struct.pack("<I", len(changed) - 4)
    return bytes(changed)


def _change_order(packets: list[tuple[int, bytes]], chance: random.Random) -> None:
    if not packets:
        return
    one, other = chance.randrange(len(packets)), chance.randrange(len(packets))
    match chance.randrange(5):
        case 0:
            packets[one], packets[other] = packets[other], packets[one]
        case 1:
            del packets[one]
        case 2:
            packets[other:other] = [packets[one]] * chance.choice((1, 1, 3, 80))
        case 3:
            packets[one] = (chance.choice((0, 1, 2, 3, -1, 70_000)), packets[one][1])
        case _:
            chance.shuffle(packets)


def _change_header(header: bytearray, chance: random.Random) -> None:
    match chance.randrange(4):
        case 0:
            table = chance.choice((*_NUMBERS, len(header), len(header) + 500, 2_000))
            at = packing.TABLE_POSITION_AT
            header[at : at + 8] = struct.pack("<q", table)
        case 1:
            text = bytes(header[_TEXT_AT:]).rstrip(b"\0")
            at = chance.randint(0, len(text))
            gone = chance.choice((0, 1, 10, 100))
            new = chance.choice((*_WORDS, *_MARKUP)) * chance.choice((1, 1, 2))
            text = text[:at] + new + text[at + gone :]
            header[_TEXT_AT:] = text
            header[_TEXT_AT - 4 : _TEXT_AT] = struct.pack("<I", len(text))
            begin = len(MAGIC)
            header[begin : begin + 4] = struct.pack("<I", max(0, len(header) - begin - 4))
        case 2:
            del header[chance.randint(0, len(header)) :]
        case _:
            _change_bytes(header, chance)


def _bomb(chance: random.Random) -> tuple[int, bytes]:
    """Returns a packet that is far larger than its place in the file."""
    n = chance.choice((70_000, 300_000, 1_200_000, 2_000_000, 2_200_000))
    if chance.random() < 0.3:
        return 1, _parts()[2][0][1] + bytes(16 * n)
    events = np.zeros(n, EVENT_DTYPE)
    events["t"] = 1_000_000 + np.arange(n) // chance.choice((1, 10, 1_000, n))
    head = packing._EVENTS_HEAD.pack(
        packing._EVENTS_HEAD.size - 4 + events.nbytes, 16, b"EVTS", 6, 8, 4, 6, 4, n
    )
    return 0, head + events.tobytes()


def _compress(data: bytes, compression: int) -> bytes:
    if compression in (LZ4, LZ4_HIGH):
        return bytes(lz4.frame.compress(data))
    if compression in (ZSTD, ZSTD_HIGH):
        from backports import zstd

        return zstd.compress(data, 1)
    return data


def _write(draft: _Draft, chance: random.Random) -> bytes:
    parts = [bytes(draft.header)]
    for stream, data in draft.packets:
        packed = _pack(data, draft.compression)
        if chance.random() < 0.02:
            changed = bytearray(packed)
            _change_bytes(changed, chance)
            packed = bytes(changed)
        size = len(packed) if chance.random() > 0.01 else chance.choice(_NUMBERS) & 0x7FFFFFFF
        parts.append(struct.pack("<ii", stream, size) + packed)
    return b"".join(parts)


@cache
def _pack_known(data: bytes, compression: int) -> bytes:
    return _compress(data, compression)


def _pack(data: bytes, compression: int) -> bytes:
    known = any(data is each for part in _parts() for _, each in part)
    return _pack_known(data, compression) if known else _compress(data, compression)


def make_recording(chance: random.Random) -> bytes:
    """Returns a recording with a few faults."""
    draft = _Draft(
        bytearray(packing.pack_header()),
        list(chance.choice(_parts())),
        chance.choice((LZ4, LZ4, LZ4, LZ4_HIGH, ZSTD, ZSTD_HIGH, NONE)),
    )
    draft.header[_COMPRESSION_AT] = draft.compression
    for _ in range(chance.choice((1, 1, 2, 4))):
        match chance.randrange(10):
            case 0 | 1:
                _change_order(draft.packets, chance)
            case 2:
                _change_header(draft.header, chance)
            case 3 if chance.random() < 0.03:
                draft.packets.insert(0, _bomb(chance))
                draft.packets *= chance.choice((1, 1, 2, 5))
            case _ if draft.packets:
                at = chance.randrange(len(draft.packets))
                stream, data = draft.packets[at]
                draft.packets[at] = (stream, _change_packet(data, chance))
    content = _write(draft, chance)
    if chance.random() < 0.15:
        content = content[: chance.randint(0, len(content))]
    if chance.random() < 0.05:
        content += chance.randbytes(chance.choice((1, 7, 8, 40)))
    return content


def check_recording(path: Path) -> None:
    """Reads a recording and checks all that comes out; every fourth is sliced instead."""
    if path.stat().st_size % 4 == 0:
        _check_slices(path)
        return
    last_us = -1
    recording = Recording(path)
    width_px, height_px = recording.size_px
    for events, frames in recording:
        t = events["t"]
        if len(events):
            assert (t[1:] >= t[:-1]).all(), "events out of order"
            assert t[0] >= last_us, "batches out of order"
            assert events["x"].min() >= 0, "x"
            assert events["x"].max() < width_px, "x"
            assert events["y"].min() >= 0, "y"
            assert events["y"].max() < height_px, "y"
            assert events["p"].view(np.uint8).max() <= 1, "p"
            last_us = int(t[-1])
        for frame in frames:
            assert frame.pixels.shape == (SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), "shape"
            assert frame.exposure_begin_us <= frame.exposure_end_us, "exposure"


def _check_slices(path: Path) -> None:
    before_us = None
    for packet in Replay(path):
        assert packet.t_end_us - packet.t_begin_us == 10_000, "length"
        assert before_us is None or packet.t_begin_us >= before_us, "overlap"
        before_us = packet.t_end_us
        if len(packet.events):
            assert packet.t_begin_us <= packet.events["t"][0], "too early"
            assert packet.events["t"][-1] < packet.t_end_us, "too late"


RECORDINGS: Final = Area(make_recording, check_recording, RecordingError, ".aedat4")
