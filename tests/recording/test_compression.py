"""A small file cannot take all memory: packets are never decompressed beyond a limit."""

import struct
import tracemalloc

import lz4.frame
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.recording import Recording
from neurotouch_hid.recording.compression import COMPRESSIONS, MAX_BYTES, NONE, decompress
from neurotouch_hid.recording.packing import pack_header
from tests.vendor import dv

COMPRESSION_AT = 14 + 4 + 28
MB = 1 << 20


def zstd_bomb(head, megabytes):
    """A size, then a run of zeros: four bytes of file for each 128 kB of memory."""
    out = struct.pack("<IBB", 0xFD2FB528, 0, (20 - 10) << 3)
    out += (len(head) << 3).to_bytes(3, "little") + head
    for k in range(n := megabytes * 8):
        block = (128 << 10) << 3 | 1 << 1 | (k == n - 1)
        out += block.to_bytes(3, "little") + b"\0"
    return out


def lz4_bomb(head, megabytes):
    return lz4.frame.compress(head + bytes(megabytes * MB), block_size=lz4.frame.BLOCKSIZE_MAX4MB)


def recording(tmp_path, compression, packet):
    """A file whose only packet is this."""
    head = bytearray(pack_header())
    head[COMPRESSION_AT : COMPRESSION_AT + 4] = struct.pack("<i", compression)
    path = tmp_path / "a.aedat4"
    path.write_bytes(bytes(head) + struct.pack("<ii", 0, len(packet)) + packet)
    return path


@pytest.mark.parametrize(
    ("compression", "bomb"), [(1, lz4_bomb), (2, lz4_bomb), (3, zstd_bomb), (4, zstd_bomb)]
)
@pytest.mark.parametrize(
    ("says", "words"), [(300 * MB, "has a packet of 300 MB"), (1000, "is damaged"), (0, "is damag")]
)
def test_a_bomb_is_refused_before_it_goes_off(tmp_path, compression, bomb, says, words):
    path = recording(tmp_path, compression, bomb(struct.pack("<I", says), 300))
    assert path.stat().st_size < 2 * MB
    tracemalloc.start()
    try:
        with pytest.raises(RecordingError, match=words):
            list(Recording(path))
        assert tracemalloc.get_traced_memory()[1] < 40 * MB
    finally:
        tracemalloc.stop()


def test_a_packet_larger_than_the_file_is_not_read(tmp_path):
    path = tmp_path / "a.aedat4"
    path.write_bytes(pack_header() + struct.pack("<ii", 0, 0x7FFFFFFF) + bytes(200))
    tracemalloc.start()
    try:
        with pytest.raises(RecordingError, match="is cut off before its first event"):
            list(Recording(path))
        assert tracemalloc.get_traced_memory()[1] < 4 * MB
    finally:
        tracemalloc.stop()


@given(n=st.integers(0, 400_000), level=st.integers(0, 9), size=st.integers(4, 7))
def test_lz4_of_every_kind_comes_back(n, level, size):
    data = np.random.default_rng(n).integers(0, 3, n, np.uint8).tobytes()
    packed = lz4.frame.compress(
        struct.pack("<I", n) + data, compression_level=level, block_size=size
    )
    assert bytes(decompress(packed, 1)) == data
    with pytest.raises(ValueError):  # noqa: PT011 - of whatever words
        decompress(packed + b"\0", 1)
    with pytest.raises(ValueError):  # noqa: PT011
        decompress(packed[:-1], 1)


@given(st.binary(max_size=200), st.sampled_from(COMPRESSIONS))
def test_no_bytes_make_it_fail(data, compression):
    for start in (b"", struct.pack("<I", 0x184D2204), struct.pack("<I", 0xFD2FB528)):
        try:
            decompress(start + data, compression)
        except ValueError:
            continue
        assert compression == NONE


def test_the_limit_is_far_above_ordinary_packets():
    assert MAX_BYTES // 16 > 100 * 10_000  # a hundred times what the maker's writer puts in one


@pytest.mark.parametrize("name", ["NONE", "LZ4", "LZ4_HIGH", "ZSTD", "ZSTD_HIGH"])
def test_the_makers_files_pass(tmp_path, name):
    config = dv.io.MonoCameraWriter.Config("camera", getattr(dv.CompressionType, name))
    config.addEventStream((346, 260))
    config.addFrameStream((346, 260))
    writer = dv.io.MonoCameraWriter(str(tmp_path / "a.aedat4"), config)
    store = dv.EventStore()
    for k in range(20_000):
        store.push_back(k, k % 346, k % 260, bool(k % 3))
    writer.writeEvents(store)
    pixels = np.arange(260 * 346, dtype=np.uint8).reshape(260, 346)
    writer.writeFrame(dv.Frame(500, pixels))
    del writer
    batches = list(Recording(tmp_path / "a.aedat4"))
    events = np.concatenate([events for events, _ in batches])
    assert np.array_equal(events["t"], np.arange(20_000))
    assert np.array_equal(events["x"], np.arange(20_000) % 346)
    assert np.array_equal(events["p"], np.arange(20_000) % 3 > 0)
    (frame,) = [frame for _, frames in batches for frame in frames]
    assert np.array_equal(frame.pixels, pixels)


def test_zstandard_takes_no_more_for_itself(tmp_path):
    wide = bytearray(zstd_bomb(struct.pack("<I", 1 << 20), 1))
    wide[5] = (27 - 10) << 3  # a window of 128 MB
    with pytest.raises(RecordingError, match="is damaged before its first event"):
        list(Recording(recording(tmp_path, 3, bytes(wide))))
