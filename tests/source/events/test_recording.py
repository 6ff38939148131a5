"""A recording of an event camera has its own pixels, and plays as the camera did."""

import numpy as np

from neurotouch_hid.recording import Recording, RecordingWriter
from neurotouch_hid.source import SizedSource
from neurotouch_hid.source.events.config import EventsConfig
from neurotouch_hid.source.events.gel_place import describe_place
from neurotouch_hid.source.events.source import EventCameraSource
from neurotouch_hid.source.replay import Replay
from neurotouch_hid.source.rig_file import rig_path
from tests.source.events.fake_library import Camera, Library, make_events

PLACED = EventsConfig(px_per_mm=5.0, centre_px=(700.0, 300.0), mirrored=True)


def film(n_packets=20):
    """A camera that sends random events, 10 ms in a packet."""
    rng = np.random.default_rng(3)
    camera = Camera()
    for k in range(n_packets):
        times = np.sort(rng.integers(10_000 * k, 10_000 * (k + 1), 3_000))
        times[0] = 10_000 * k
        x, y = rng.integers(640, 760, 3_000), rng.integers(280, 330, 3_000)
        camera.show(10_000 * (k + 1), make_events(times, x, y, rng.integers(2, size=3_000)))
    return camera


def collect(packets, end_us=190_000):
    events = []
    for packet in packets:
        events.append(packet.events)
        if packet.t_end_us >= end_us:
            return np.concatenate(events)
    raise AssertionError("the source has ended")


def open_camera(config):
    return EventCameraSource("", config, library=Library(film()), max_delay_us=60_000_000)


def test_all_events_are_recorded_in_the_pixels_of_the_sensor(tmp_path):
    path = tmp_path / "a.aedat4"
    with open_camera(PLACED) as source:
        assert isinstance(source, SizedSource)
        assert source.sensor == ("Prophesee EVK4", 1280, 720)
        events = collect(source.sensor_packets())
        with RecordingWriter(path, sensor=source.sensor) as writer:
            writer.write_events(events)
    sent = np.concatenate([packet.polarity_events for _, packet, _ in film().script[:19]])
    recorded = np.concatenate([got for got, _ in Recording(path)])
    for name, own in (("t", "t"), ("x", "x"), ("y", "y"), ("on", "p")):
        assert np.array_equal(sent[name].astype(np.int64), recorded[own].astype(np.int64)), name


def test_a_recording_plays_as_the_camera_did(tmp_path):
    for number, config in enumerate([EventsConfig(), PLACED]):
        path = tmp_path / f"{number}.aedat4"
        with open_camera(config) as source:
            shown = collect(source)
        with open_camera(config) as source:
            events = collect(source.sensor_packets())
            with RecordingWriter(path, sensor=source.sensor) as writer:
                writer.write_events(events)
        if rig := describe_place(config):
            rig_path(path).write_bytes(rig)
        replay = Replay(path)
        assert replay.rig is None
        played = np.concatenate([packet.events for packet in replay])
        assert len(shown) > 500
        assert np.array_equal(played, shown[: len(played)])
        assert len(played) == len(shown)
