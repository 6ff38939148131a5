"""A recording is readable at every moment, whatever ends it."""

import os
import resource
import shutil
import stat
from contextlib import contextmanager
from types import SimpleNamespace

import numpy as np
import pytest

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import EVENT_DTYPE, Frame
from neurotouch_hid.recording import Recording, RecordingWriter
from tests.recording.streams import ORIGIN_US, make_events, make_packets
from tests.vendor import dv


def count(path):
    """Events and frames, as we read them."""
    batches = list(Recording(path))
    return sum(len(events) for events, _ in batches), sum(len(frames) for _, frames in batches)


def count_with_the_maker(path):
    recording = dv.io.MonoCameraRecording(str(path))
    events = frames = 0
    while (store := recording.getNextEventBatch()) is not None:
        events += store.size()
    while recording.getNextFrame() is not None:
        frames += 1
    return events, frames


def expect(packets):
    return sum(len(p.events) for p in packets), sum(len(p.frames) for p in packets)


@contextmanager
def largest_file(n_bytes):
    """The kernel refuses to write beyond, as it does on a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (n_bytes, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_in_place_it_is_there_and_readable_after_every_packet(tmp_path):
    path, packets = tmp_path / "a.aedat4", make_packets(4_000)
    with RecordingWriter(path, in_place=True) as writer:
        for n, packet in enumerate(packets, 1):
            writer.write(packet)
            copy = shutil.copy(path, tmp_path / "copy.aedat4")
            assert count(copy) == expect(packets[:n])
    assert count(path) == count_with_the_maker(path) == expect(packets)


def test_a_second_recording_into_the_same_file_is_refused(tmp_path):
    path, packets = tmp_path / "a.aedat4", make_packets(4_000)
    with RecordingWriter(path, in_place=True) as writer:
        writer.write(packets[0])
        with pytest.raises(RecordingError, match="Another program is recording to"):
            RecordingWriter(path, in_place=True)
        writer.write(packets[1])
    assert count(path) == expect(packets[:2])
    with RecordingWriter(path, in_place=True) as writer:
        writer.write(packets[0])
    assert count(path) == expect(packets[:1])


def test_without_its_table_the_maker_reads_it_too(tmp_path):
    writer = RecordingWriter(tmp_path / "a.aedat4", in_place=True)
    packets = make_packets(4_000)
    for packet in packets:
        writer.write(packet)
    assert count_with_the_maker(tmp_path / "a.aedat4") == expect(packets)
    writer.close()


@pytest.mark.parametrize("error", [KeyboardInterrupt, RuntimeError])
def test_in_place_an_interruption_leaves_what_there_is(tmp_path, error):
    path, packets = tmp_path / "a.aedat4", make_packets(1_000)

    def write():
        with RecordingWriter(path, in_place=True) as writer:
            writer.write(packets[0])
            raise error

    with pytest.raises(error):
        write()
    assert count(path) == count_with_the_maker(path) == expect(packets[:1])


@pytest.mark.parametrize("limit_bytes", [40_000, 100_000, 100_001, 133_003])
def test_a_disk_that_gets_full_leaves_whole_packets(tmp_path, limit_bytes):
    path, packets, written = tmp_path / "a.aedat4", make_packets(), 0
    writer = RecordingWriter(path, in_place=True)
    with largest_file(limit_bytes):
        with pytest.raises(RecordingError, match="cannot be written: File too large"):  # noqa: PT012
            for packet in packets:
                writer.write_events(packet.events)
                written += len(packet.events)
        writer.close()
    assert 0 < written < 20_000
    assert path.stat().st_size <= limit_bytes
    assert count(path) == count_with_the_maker(path) == (written, 0)


def test_a_disk_without_room_for_a_header_makes_no_file(tmp_path):
    with (
        largest_file(100),
        pytest.raises(RecordingError, match="cannot be written: File too large"),
    ):
        RecordingWriter(tmp_path / "a.aedat4", in_place=True)
    assert list(tmp_path.iterdir()) == []


def test_after_a_full_disk_it_goes_on_where_the_last_packet_ends(tmp_path):
    path = tmp_path / "a.aedat4"
    with RecordingWriter(path, in_place=True) as writer:
        writer.write_events(make_events(1_000, 10_000))
        with (
            largest_file(writer.size_bytes + 5_000),
            pytest.raises(RecordingError, match="cannot be written: File too large"),
        ):
            writer.write_events(make_events(20_000, 10_000, 1, ORIGIN_US + 10_000))
        writer.write_events(make_events(300, 10_000, 2, ORIGIN_US + 20_000))
    assert count(path) == count_with_the_maker(path) == (1_300, 0)


def test_a_second_close_does_nothing_and_nothing_is_removed_after_the_first(tmp_path):
    for in_place in (True, False):
        path = tmp_path / f"{in_place}.aedat4"
        writer = RecordingWriter(path, in_place=in_place)
        writer.write_events(at(1))
        writer.close()
        before = path.read_bytes()
        writer.close()
        writer.discard()
        assert path.read_bytes() == before


def test_an_interruption_leaves_no_file_that_has_not_its_name_yet(tmp_path):
    def write():
        with RecordingWriter(tmp_path / "a.aedat4") as writer:
            writer.write_events(at(1))
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        write()
    assert list(tmp_path.iterdir()) == []


def test_in_place_it_has_the_mode_of_other_files(tmp_path):
    mask = os.umask(0o022)
    try:
        RecordingWriter(tmp_path / "a.aedat4", in_place=True).close()
    finally:
        os.umask(mask)
    assert stat.S_IMODE((tmp_path / "a.aedat4").stat().st_mode) == 0o644


@pytest.mark.parametrize("content", [b"precious", None])
def test_in_place_a_link_that_waits_under_the_name_is_not_followed(tmp_path, content):
    victim, path = tmp_path / "victim", tmp_path / "a.aedat4"
    if content is not None:
        victim.write_bytes(content)
    path.symlink_to(victim)
    with pytest.raises(RecordingError, match=r"a\.aedat4' is a link"):
        RecordingWriter(path, in_place=True)
    assert path.is_symlink()
    assert (victim.read_bytes() if victim.exists() else None) == content


@pytest.mark.parametrize("n_packets", range(1, 8))
def test_the_table_leads_to_every_packet(tmp_path, n_packets):
    """The table's rows are aligned for every number of packets: the maker's reader uses it."""
    path = tmp_path / "a.aedat4"
    events = make_events(1_000, 70_000)
    with RecordingWriter(path) as writer:
        for part in np.array_split(events, n_packets):
            writer.write_events(part)
    recording = dv.io.MonoCameraRecording(str(path))
    low, high = recording.getTimeRange()
    assert (low, high) == (int(events["t"][0]), int(events["t"][-1]))
    assert count_with_the_maker(path) == (1_000, 0)


def at(*times_us):
    events = np.zeros(len(times_us), EVENT_DTYPE)
    events["t"] = times_us
    return events


def picture(begin_us):
    return Frame(np.zeros((260, 346), np.uint8), begin_us, begin_us + 5)


def test_what_is_not_older_is_in_order(tmp_path):
    path = tmp_path / "a.aedat4"
    with RecordingWriter(path) as writer:
        for events in (at(0), at(5, 5), at(), at(5)):
            writer.write_events(events)
        for wrong in (at(4), at(6, 5), at(-1)):
            with pytest.raises(RecordingError, match="events must be written in order of time"):
                writer.write_events(wrong)
        with pytest.raises(RecordingError, match="frames must be written in order of time"):
            writer.write_frame(picture(-1))
        for begin_us in (0, 7, 7):
            writer.write_frame(picture(begin_us))
        with pytest.raises(RecordingError, match="frames must be written in order of time"):
            writer.write_frame(picture(6))
    assert count(path) == (4, 3)


def test_it_leaves_as_much_of_the_disk_as_it_says(tmp_path, monkeypatch):
    free = [1 << 20]
    monkeypatch.setattr(shutil, "disk_usage", lambda _folder: SimpleNamespace(free=free[0]))
    path = tmp_path / "a.aedat4"
    with RecordingWriter(path, min_free_bytes=1 << 20) as writer:
        writer.write_events(at(1))
        free[0] -= 1
        with pytest.raises(RecordingError, match="the disk is full") as refused:
            writer.write_events(at(2))
        assert refused.value.hint == "Make room: 1 MB have to stay free."
    assert count(path) == (1, 0)
    with pytest.raises(RecordingError, match="the disk is full"):
        RecordingWriter(tmp_path / "b.aedat4", min_free_bytes=1 << 20)
    assert list(tmp_path.iterdir()) == [path]


def test_no_byte_of_memory_that_is_not_ours_gets_into_the_file(tmp_path):
    """The padding of a record is whatever was there before; a file must not carry it."""
    dirty = np.frombuffer(b"\xee" * 16 * 500, EVENT_DTYPE).copy()
    for name in ("t", "x", "y", "p"):
        dirty[name] = 1
    clean = np.zeros(500, EVENT_DTYPE)
    for name in ("t", "x", "y", "p"):
        clean[name] = 1
    sizes = []
    for name, events in (("dirty", dirty), ("clean", clean)):
        with RecordingWriter(tmp_path / name) as writer:
            writer.write_events(events)
        sizes.append((tmp_path / name).read_bytes())
    assert sizes[0] == sizes[1]
