"""Where packets come from: ahead of time, waited for by nobody, again and again."""

import threading

import pytest
from neurotouch_devtools.cli.emulate import _repeat
from neurotouch_devtools.emulator import CameraConfig, Prefetch
from neurotouch_devtools.emulator.prefetch import N_AHEAD

from neurotouch_hid.errors import RecordingError
from tests.emulator.host import Host, list_events, make_scene


def take(ahead, n):
    """The next packets, waiting for each."""
    packets, coming = [], iter(ahead)
    while len(packets) < n:
        packet = next(coming)
        if packet is not None:
            packets.append(packet)
    return packets


def test_packets_are_pulled_ahead_but_not_without_limit():
    pulled = []
    scene = make_scene()

    def source():
        for k in range(10 * N_AHEAD):
            pulled.append(k)
            yield scene[k % len(scene)]

    with Prefetch(source()) as ahead:
        assert take(ahead, 20) == scene
        while len(pulled) < N_AHEAD:
            pass
    assert len(pulled) <= N_AHEAD + 22


def test_what_is_not_there_yet_is_none_and_the_end_is_the_end():
    go, scene = threading.Event(), make_scene()

    def source():
        yield scene[0]
        go.wait(60.0)
        yield scene[1]

    with Prefetch(source()) as ahead:
        coming = iter(ahead)
        while (first := next(coming)) is None:
            pass
        assert first is scene[0]
        assert next(coming) is None
        go.set()
        rest = [packet for packet in coming if packet is not None]
    assert rest == [scene[1]]


def test_a_source_that_fails_gives_what_it_had_first():
    scene = make_scene()

    def source():
        yield scene[0]
        raise RecordingError("it is cut off")

    with Prefetch(source()) as ahead:
        coming = iter(ahead)
        seen = []
        with pytest.raises(RecordingError):
            seen.extend(coming)
    assert [packet for packet in seen if packet is not None] == scene[:1]


def test_the_scene_stands_still_until_more_of_it_is_known():
    scene = make_scene(length_us=400_000, n_frames=7)
    coming = [*scene[:20], *[None] * 500, *scene[20:]]
    host = Host(coming, CameraConfig())
    host.read_part()
    host.switch_on()
    host.wait(1_500_000)
    heard = host.listen()
    assert [event[1:] for event in heard.events] == [event[1:] for event in list_events(scene)]
    assert len(heard.frames) == 7
    times = [t for t, *_ in heard.events]
    assert times[-1] - times[0] > 600_000
    assert host.camera.n_dropped == 0


def test_a_source_is_repeated_in_one_time():
    scene = make_scene()
    shown = list_events(scene)
    seen = [packet for packet, _ in zip(_repeat(scene), range(60), strict=False)]
    assert [packet.t_begin_us for packet in seen] == [10_000 * k for k in range(60)]
    assert [event[1:] for event in list_events(seen)] == 3 * [event[1:] for event in shown]
    times = [t for t, *_ in list_events(seen)]
    assert times == sorted(times)
    assert [f.exposure_end_us for packet in seen for f in packet.frames][:6] == [
        *(24_000, 74_000, 124_000),
        *(224_000, 274_000, 324_000),
    ]
    assert list_events(scene) == shown
    assert list(_repeat([])) == []
