"""What we write can be read, by us and by the maker's library; bad files are explained."""

import struct

import numpy as np
import pytest

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame
from neurotouch_hid.recording import Recording, RecordingWriter, Sensor
from tests.recording.streams import ORIGIN_US, make_events, make_frames, make_packets
from tests.vendor import dv


def write(path, packets):
    with RecordingWriter(path) as writer:
        for packet in packets:
            writer.write(packet)
    return path


def read(path):
    batches = list(Recording(path))
    events = np.concatenate([events for events, _ in batches])
    return events, [frame for _, frames in batches for frame in frames]


def read_with_the_maker(path):
    """Events and frames as ``dv_processing`` gives them: a second reader."""
    recording = dv.io.MonoCameraRecording(str(path))
    parts, frames = [], []
    while (store := recording.getNextEventBatch()) is not None:
        parts.append(store.numpy())
    while (frame := recording.getNextFrame()) is not None:
        frames.append(frame)
    return np.concatenate(parts), frames


def assert_same(ours, theirs):
    events, frames = ours
    other_events, other_frames = theirs
    for name, other in (("t", "timestamp"), ("x", "x"), ("y", "y"), ("p", "polarity")):
        assert np.array_equal(events[name], other_events[other])
    assert len(frames) == len(other_frames)
    for frame, other in zip(frames, other_frames, strict=True):
        assert frame.exposure_begin_us == other.timestamp
        assert (
            frame.exposure_end_us - frame.exposure_begin_us == other.exposure.total_seconds() * 1e6
        )
        assert np.array_equal(frame.pixels, other.image)


def test_written_is_read_again(tmp_path):
    packets = make_packets()
    events, frames = read(write(tmp_path / "a.aedat4", packets))
    assert events.dtype == EVENT_DTYPE
    assert np.array_equal(events, np.concatenate([p.events for p in packets]))
    given = [frame for packet in packets for frame in packet.frames]
    assert len(frames) == len(given) == 5
    for frame, other in zip(frames, given, strict=True):
        assert (frame.exposure_begin_us, frame.exposure_end_us) == (
            other.exposure_begin_us,
            other.exposure_end_us,
        )
        assert np.array_equal(frame.pixels, other.pixels)


def test_the_maker_reads_what_we_write(tmp_path):
    path = write(tmp_path / "a.aedat4", make_packets())
    assert_same(read(path), read_with_the_maker(path))
    recording = dv.io.MonoCameraRecording(str(path))
    assert recording.getCameraName() == "DAVIS346"
    assert recording.getEventResolution() == (346, 260)


def test_a_real_camera(sample):
    events, frames = read(sample)
    assert len(events) == 6676
    assert len(frames) == 4
    assert_same((events, frames), read_with_the_maker(sample))


def test_a_recording_can_be_read_twice(tmp_path):
    recording = Recording(write(tmp_path / "a.aedat4", make_packets(1000)))
    assert [len(events) for events, _ in recording] == [len(events) for events, _ in recording]


@pytest.mark.parametrize("frames_first", [True, False])
def test_streams_one_after_the_other_come_in_order_of_time(tmp_path, frames_first):
    events, frames = make_events(5_000, 5_000_000), make_frames(20, 5_000_000)
    with RecordingWriter(tmp_path / "a.aedat4") as writer:
        if frames_first:
            for frame in frames:
                writer.write_frame(frame)
        for part in np.array_split(events, 50):
            writer.write_events(part)
        if not frames_first:
            for frame in frames:
                writer.write_frame(frame)
    n_frames, reached_us = 0, ORIGIN_US
    for part, some in Recording(tmp_path / "a.aedat4"):
        n_frames += len(some)
        for frame in some:
            assert frame.exposure_end_us >= reached_us
        if len(part):
            reached_us = int(part["t"][-1])
            assert all(frame.exposure_end_us <= reached_us for frame in some)
    assert n_frames == 20


def test_nothing_appears_before_it_is_complete(tmp_path):
    path = tmp_path / "a.aedat4"
    path.write_bytes(b"older")
    with RecordingWriter(path) as writer:
        writer.write(make_packets(100)[0])
        assert path.read_bytes() == b"older"
    assert len(read(path)[0])
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("error", [KeyboardInterrupt, RuntimeError])
def test_an_interrupted_recording_leaves_nothing(tmp_path, error):
    def packets():
        yield make_packets(100)[0]
        raise error

    with pytest.raises(error):
        write(tmp_path / "a.aedat4", packets())
    assert list(tmp_path.iterdir()) == []


def test_writing_into_a_missing_folder(tmp_path):
    with pytest.raises(RecordingError, match="cannot be written: No such file"):
        RecordingWriter(tmp_path / "no" / "a.aedat4")


def test_a_full_disk(tmp_path):
    with (
        pytest.raises(RecordingError, match="the disk is full"),
        RecordingWriter(tmp_path / "a.aedat4", min_free_bytes=1 << 62) as writer,
    ):
        writer.write_frame(make_frames(1, 1000)[0])
    assert list(tmp_path.iterdir()) == []


def test_events_must_be_written_in_order(tmp_path):
    late, early = make_packets(1000)[5], make_packets(1000)[4]
    with pytest.raises(RecordingError, match="order of time"):
        write(tmp_path / "a.aedat4", [late, early])
    assert list(tmp_path.iterdir()) == []


def test_frames_must_be_written_in_order(tmp_path):
    early, late = make_frames(2, 100_000)
    packet = EventPacket(0, 1, np.empty(0, EVENT_DTYPE), (late, early))
    with pytest.raises(RecordingError, match="frames must be written in order"):
        write(tmp_path / "a.aedat4", [packet])


def with_dv(path, resolution=(346, 260), *, events=True, frames=True, fill=lambda writer: None):
    config = dv.io.MonoCameraWriter.Config("camera", dv.CompressionType.NONE)
    if events:
        config.addEventStream(resolution)
    if frames:
        config.addFrameStream(resolution)
    writer = dv.io.MonoCameraWriter(str(path), config)
    fill(writer)
    del writer
    return path


def refusal(path):
    with pytest.raises(RecordingError) as caught:
        for _ in Recording(path):
            pass
    message, quoted = caught.value.message, f"'{path}'"
    assert message.endswith(".")
    return message.removeprefix(quoted).removeprefix(str(path)).removesuffix(".")


def test_missing(tmp_path):
    assert refusal(tmp_path / "a.aedat4") == f"There is no file '{tmp_path / 'a.aedat4'}'"


def test_a_folder(tmp_path):
    assert refusal(tmp_path) == " is a folder"


def test_empty(tmp_path):
    (tmp_path / "a.aedat4").touch()
    assert refusal(tmp_path / "a.aedat4") == " is empty (0 bytes)"


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"#!AER-DAT3.1\r\n", " is an AEDAT 3.1 file, not AEDAT4"),
        (b"% Evt 3.0\nabcdefgh", " is not an AEDAT4 recording"),
        (b"#!AER-DAT4.0\r\n", " is cut off inside its header"),
        (b"#!AER-", " is cut off inside its header"),
        (b"#!AER-DAT4.0\r\n" + b"\xff" * 100, " has a damaged header"),
        (b"#!AER-DAT4.0\r\n\x40\0\0\0" + b"\0" * 100, " has a damaged header"),
    ],
)
def test_other_formats(tmp_path, data, words):
    (tmp_path / "a.aedat4").write_bytes(data)
    assert refusal(tmp_path / "a.aedat4") == words


def test_another_camera(tmp_path):
    """Events of any sensor are read; its frames are not."""

    def fill(writer):
        store = dv.EventStore()
        store.push_back(5, 639, 479, True)
        writer.writeEvents(store)

    recording = Recording(with_dv(tmp_path / "a.aedat4", (640, 480), fill=fill))
    assert recording.size_px == (640, 480)
    assert not recording.has_frames
    assert [events.tolist() for events, _ in recording] == [[(5, 639, 479, True)]]


def test_a_recording_of_another_sensor_is_read_by_its_maker_and_by_us(tmp_path):
    path, sensor = tmp_path / "a.aedat4", Sensor("Prophesee EVK4", 1280, 720)
    events = np.zeros(2, EVENT_DTYPE)
    events["t"], events["x"], events["y"], events["p"] = [3, 7], [1279, 4], [719, 5], [True, False]
    with RecordingWriter(path, sensor=sensor) as writer:
        writer.write(EventPacket(0, 10, events))
    reader = dv.io.MonoCameraRecording(str(path))
    assert tuple(reader.getEventResolution()) == (1280, 720)
    assert reader.getCameraName() == "Prophesee EVK4"
    assert len(reader.getNextEventBatch()) == 2
    recording = Recording(path)
    assert recording.size_px == (1280, 720)
    assert np.concatenate([got for got, _ in recording]).tolist() == events.tolist()


def test_a_size_that_no_sensor_has(tmp_path):
    path = tmp_path / "a.aedat4"
    with RecordingWriter(path, sensor=Sensor("X", 9000, 1)) as writer:
        writer.write(EventPacket(0, 10, np.zeros(1, EVENT_DTYPE)))
    assert refusal(path) == " is 9000×1, no sensor's size"


def test_no_stream_of_events(tmp_path):
    assert refusal(with_dv(tmp_path / "a.aedat4", events=False)) == " has no stream of events"


def test_no_events(tmp_path):
    frame = EventPacket(0, 1, np.empty(0, EVENT_DTYPE), make_frames(3, 1000))
    assert refusal(write(tmp_path / "a.aedat4", [frame])) == " has no events"


def test_no_stream_of_frames_is_said(tmp_path):
    def fill(writer):
        store = dv.EventStore()
        store.push_back(5, 1, 2, True)
        writer.writeEvents(store)

    recording = Recording(with_dv(tmp_path / "a.aedat4", frames=False, fill=fill))
    assert not recording.has_frames
    assert [len(events) for events, _ in recording] == [1]


def stores(*stamps_and_columns):
    def fill(writer):
        for t, x in stamps_and_columns:
            store = dv.EventStore()
            store.push_back(t, x, 2, True)
            writer.writeEvents(store)

    return fill


def test_stamps_that_go_back(tmp_path):
    path = with_dv(tmp_path / "a.aedat4", fill=stores((500_000, 1), (700_000, 1)))
    data, old, new = path.read_bytes(), struct.pack("<q", 700_000), struct.pack("<q", 40_000)
    assert data.count(old) == 3  # in the event and twice in the table
    path.write_bytes(data.replace(old, new))
    assert refusal(path) == ": the stamps go back from 500000 to 40000 µs"


def test_frames_that_go_back(tmp_path):
    def fill(writer):
        stores((500_000, 1))(writer)
        for t_us in (400_000, 600_000):
            writer.writeFrame(dv.Frame(t_us, np.zeros((260, 346), np.uint8)))

    path = with_dv(tmp_path / "a.aedat4", fill=fill)
    old, new = struct.pack("<q", 600_000), struct.pack("<q", 100_000)
    path.write_bytes(path.read_bytes().replace(old, new))
    assert refusal(path) == ": the stamps go back from 400000 to 100000 µs"


@pytest.mark.parametrize("place", [(346, 2), (-1, 2), (5, 260), (5, -1)])
def test_events_outside_the_sensor(tmp_path, place):
    path = with_dv(tmp_path / "a.aedat4", fill=stores((500, 7)))
    good = struct.pack("<qhh", 500, 7, 2)
    data = path.read_bytes()
    assert data.count(good) == 1
    path.write_bytes(data.replace(good, struct.pack("<qhh", 500, *place)))
    assert "outside its 346×260 pixels" in refusal(path)


def test_frames_of_another_size(tmp_path):
    def fill(writer):
        stores((500, 1))(writer)
        writer.writeFrame(dv.Frame(400, np.zeros((100, 200), np.uint8)))

    path = with_dv(tmp_path / "a.aedat4", fill=fill)
    assert refusal(path) == " has a frame of 200×100 pixels, not 346×260 of 8 bit"


def test_colour_becomes_grey(tmp_path):
    def fill(writer):
        stores((500, 1))(writer)
        pixels = np.zeros((260, 346, 3), np.uint8)
        pixels[:, :, 1] = 90
        writer.writeFrame(dv.Frame(400, pixels))

    ((frame,),) = [frames for _, frames in Recording(with_dv(tmp_path / "a.aedat4", fill=fill))]
    assert frame.pixels.shape == (260, 346)
    assert (frame.pixels == 30).all()
    assert frame.exposure_begin_us == frame.exposure_end_us == 400


def test_a_cut_recording_gives_what_is_there(tmp_path):
    path = write(tmp_path / "a.aedat4", make_packets())
    path.write_bytes(path.read_bytes()[: path.stat().st_size * 6 // 10])
    batches = []
    with pytest.raises(RecordingError, match=r"is cut off 0\.1\d\d s after its first event"):
        batches.extend(Recording(path))  # keeps what came before the error
    assert 8_000 < sum(len(events) for events, _ in batches) < 16_000
    assert sum(len(frames) for _, frames in batches) >= 2


def test_frame_memory_is_our_own(tmp_path):
    frame = Frame(np.full((260, 346), 7, np.uint8), 1_000, 2_000)
    events = make_events(10, 5_000, origin_us=0)
    _, (again,) = read(write(tmp_path / "a.aedat4", [EventPacket(0, 1, events, (frame,))]))
    assert again.pixels.base is None
    assert again.t_us == 1_500
