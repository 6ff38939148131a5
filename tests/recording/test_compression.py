"""A small file cannot take all memory: what a packet gets is known before it is decompressed."""

import io
import struct

import lz4.frame
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.recording import Recording
from neurotouch_hid.recording.compression import MAX_BYTES, bound_lz4, bound_zstd
from neurotouch_hid.recording.packing import TABLE_POSITION_AT, pack_events, pack_header
from tests.recording.streams import make_events
from tests.vendor import dv

COMPRESSION_AT = 14 + 4 + 28
MB = 1 << 20


def reader(data):
    file = io.BytesIO(data)

    def read(position, n):
        file.seek(position)
        return file.read(n)

    return read


def zstd_bomb(megabytes, *, last=True):
    """A run of zeros: four bytes of file for each 128 kB of memory."""
    out = struct.pack("<IBB", 0xFD2FB528, 0, (27 - 10) << 3)
    n = megabytes * 8
    for k in range(n):
        block = (128 << 10) << 3 | 1 << 1 | (last and k == n - 1)
        out += block.to_bytes(3, "little") + b"\0"
    return out


def lz4_bomb(megabytes):
    zeros = bytes(megabytes * MB)
    return lz4.frame.compress(zeros, block_size=lz4.frame.BLOCKSIZE_MAX4MB)


def recording(tmp_path, compression, packet, *, table=False):
    """A file whose only packet, or whose table, is this."""
    head = bytearray(pack_header())
    head[COMPRESSION_AT : COMPRESSION_AT + 4] = struct.pack("<i", compression)
    if table:
        head[TABLE_POSITION_AT : TABLE_POSITION_AT + 8] = struct.pack("<q", len(head))
        data = packet
    else:
        data = struct.pack("<ii", 0, len(packet)) + packet
    path = tmp_path / "a.aedat4"
    path.write_bytes(bytes(head) + data)
    return path


@pytest.mark.parametrize("table", [False, True])
@pytest.mark.parametrize(
    ("compression", "bomb"), [(1, lz4_bomb), (2, lz4_bomb), (3, zstd_bomb), (4, zstd_bomb)]
)
def test_a_bomb_is_refused_before_it_goes_off(tmp_path, compression, bomb, table):
    path = recording(tmp_path, compression, bomb(300), table=table)
    assert path.stat().st_size < 2 * MB
    with pytest.raises(RecordingError, match="300 MB in one piece"):
        list(Recording(path))


def test_two_frames_in_one_packet_count_together(tmp_path):
    skipped = struct.pack("<II", 0x184D2A53, 5) + b"words"
    path = recording(tmp_path, 3, zstd_bomb(200) + skipped + zstd_bomb(100))
    with pytest.raises(RecordingError, match="300 MB in one piece"):
        list(Recording(path))


def test_a_frame_that_breaks_off_counts_up_to_there():
    data = zstd_bomb(2, last=False)
    assert bound_zstd(reader(data), 0, len(data)) == 2 * MB


@given(n=st.integers(0, 400_000), level=st.integers(0, 9), size=st.integers(4, 7))
def test_the_bound_of_lz4_is_never_too_small(n, level, size):
    data = np.random.default_rng(n).integers(0, 3, n, np.uint8).tobytes()
    packed = lz4.frame.compress(data, compression_level=level, block_size=size)
    most = bound_lz4(reader(packed), 0, len(packed))
    if n == 0:
        assert most == -1
    else:
        assert n <= most <= n + (4 << 20)


@given(st.binary(max_size=200))
def test_no_bytes_make_it_fail(data):
    for start in (b"", struct.pack("<I", 0x184D2204), struct.pack("<I", 0xFD2FB528)):
        for bound in (bound_lz4, bound_zstd):
            bound(reader(start + data), 0, len(start + data))


def test_an_ordinary_packet_is_far_below_the_limit():
    packet = pack_events(make_events(100_000, 10_000))[8:]
    assert bound_lz4(reader(packet), 0, len(packet)) < MAX_BYTES // 50


@pytest.mark.parametrize("name", ["NONE", "LZ4", "LZ4_HIGH", "ZSTD", "ZSTD_HIGH"])
def test_the_makers_files_pass(tmp_path, name):
    config = dv.io.MonoCameraWriter.Config("camera", getattr(dv.CompressionType, name))
    config.addEventStream((346, 260))
    writer = dv.io.MonoCameraWriter(str(tmp_path / "a.aedat4"), config)
    store = dv.EventStore()
    for k in range(20_000):
        store.push_back(k, k % 346, k % 260, bool(k % 3))
    writer.writeEvents(store)
    del writer
    assert sum(len(events) for events, _ in Recording(tmp_path / "a.aedat4")) == 20_000
