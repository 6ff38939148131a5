"""A recording of simulated data says so in its header, and every AEDAT4 program still reads it."""

import os
import shutil

import pytest

from neurotouch_hid.driver import Driver, DriverOptions
from neurotouch_hid.errors import RecordingError
from neurotouch_hid.recording import Recording, RecordingWriter, Simulation
from neurotouch_hid.source import open_source
from tests.recording.streams import make_packets
from tests.recording.test_writer import count, count_with_the_maker, expect

MARK = Simulation("neurotouch-hid 1.2.3", "sim:tour", "neurotouch record a.aedat4 --seed 7", 7)


def write(path, mark):
    with RecordingWriter(path, simulation=mark) as writer:
        for packet in make_packets(4_000):
            writer.write(packet)
    return path


@pytest.mark.parametrize(
    "mark",
    [
        MARK,
        Simulation("p", "sim:mouse"),
        Simulation("a & b", 'sim:"<x>"', "neurotouch record 'é \u202e.aedat4'", 0),
    ],
)
def test_the_mark_is_read_back_and_the_maker_reads_the_file(tmp_path, mark):
    path = write(tmp_path / "a.aedat4", mark)
    read = Recording(path).simulation
    assert read is not None
    assert (read.program, read.source, read.seed) == (mark.program, mark.source, mark.seed)
    assert read.command == mark.command.replace("\u202e", "�")
    assert count(path) == count_with_the_maker(path) == expect(make_packets(4_000))


def test_a_sensors_recording_has_none(tmp_path):
    path = write(tmp_path / "a.aedat4", None)
    assert Recording(path).simulation is None
    with open_source(f"file:{path}") as source:
        assert source.is_simulated is False


def test_who_plays_it_says_that_it_is_simulated(tmp_path):
    path = write(tmp_path / "a.aedat4", MARK)
    with open_source(f"file:{path}") as source:
        assert source.is_simulated is True


def test_a_long_command_line_is_cut(tmp_path):
    path = write(tmp_path / "a.aedat4", Simulation("p", "s", "x" * 500_000))
    assert Recording(path).simulation == Simulation("p", "s", "x" * 1000)


@pytest.mark.parametrize(
    ("before", "after", "seed"),
    [(b">7<", b">q<", None), (b'"seed"', b'"need"', None), (b">sim:tour<", b">SIM:TOUR<", 7)],
)
def test_a_mark_of_another_program_may_lack_anything(tmp_path, before, after, seed):
    path = write(tmp_path / "a.aedat4", MARK)
    content = path.read_bytes()
    assert content.count(before) == 1
    path.write_bytes(content.replace(before, after))
    read = Recording(path).simulation
    assert read is not None
    assert read.seed == seed


def test_a_header_that_is_cut_off_is_refused(tmp_path):
    path = shutil.copy(write(tmp_path / "a.aedat4", MARK), tmp_path / "b.aedat4")
    os.truncate(path, 300)
    with pytest.raises(RecordingError, match="cut off"):
        Recording(path)


def test_frames_of_a_marked_recording_are_processed_in_the_pipeline(tmp_path):
    """Beside it, as those of a live simulation, the steps would depend on the speed."""
    path = write(tmp_path / "a.aedat4", MARK)
    options = DriverOptions(
        source=f"file:{path}", profile="default", device="memory", personal=False, listens=False
    )
    with Driver(options) as driver:
        assert not driver.pipeline.has_frame_thread
