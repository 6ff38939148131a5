"""The device model, with no transport but its port and a clock that the test turns."""

from itertools import pairwise

import pytest
from neurotouch_devtools.emulator import CameraConfig

from neurotouch_hid.messages import EventPacket
from tests.emulator.host import Host, list_events, make_scene


def shifted(events, t_us):
    return [(t + t_us, x, y, on) for t, x, y, on in events]


def test_a_driver_hears_the_scene_from_its_beginning():
    scene = make_scene()
    host = Host(scene, CameraConfig(lead_us=5000))
    host.switch_on()
    host.reset_time()
    host.wait(400_000)
    heard = host.listen()
    assert heard.events == shifted(list_events(scene), 5000)
    assert [frame["exposure_begin"] for frame in heard.frames] == [25_000, 75_000, 125_000]
    assert heard.resets == 1
    assert host.camera.ended


@pytest.mark.parametrize("pace", [0.1, 0.5])
def test_in_slow_motion_the_same_is_heard_with_the_same_times(pace):
    scene = make_scene()
    host = Host(scene, CameraConfig(lead_us=5000, pace=pace))
    host.switch_on()
    host.reset_time()
    host.wait(round(150_000 / pace), step_us=round(500 / pace))
    assert 145_000 < host.listen().t <= 150_000
    host.wait(round(250_000 / pace), step_us=round(500 / pace))
    heard = host.listen()
    assert heard.events[-1][0] == list_events(scene)[-1][0] + 5000
    assert [frame["exposure_begin"] for frame in heard.frames] == [25_000, 75_000, 125_000]


def test_nothing_is_said_before_the_reset_word_that_is_dated_after_it():
    host = Host(make_scene())
    host.switch_on()
    host.wait(100_000)
    host.reset_time()
    host.wait(200_000)
    before, _, after = host.data.partition(b"\x01\x00")
    assert before
    assert after
    assert host.listen().t < 210_000
    shown = list_events(make_scene())
    late = [event for event in shown if event[0] >= 100_000]
    assert host.listener.events[-len(late) :] == shifted(late, -100_000)


def test_it_may_wait_until_the_clock_is_reset_however_long_that_takes():
    scene = make_scene()
    host = Host(scene, CameraConfig(await_reset=True, lead_us=5000))
    for _ in range(2):  # a driver may give up, and start it anew
        host.switch_on()
        host.wait(400_000)
        assert not host.listen().events
        for address in [(1, 3), (2, 4)]:
            host.write(*address, 0)
    host.switch_on()
    host.wait(400_000)
    host.reset_time()
    host.wait(400_000)
    assert host.listen().events == shifted(list_events(scene), 5000)


def test_what_begins_late_is_shown_from_then_on():
    scene = make_scene()

    def come():
        while host.now_us < 300_000:
            yield None
        yield from scene

    host = Host(come())
    host.switch_on()
    host.wait(800_000)
    heard, shown = host.listen().events, list_events(scene)
    assert heard == shifted(shown, heard[0][0] - shown[0][0])
    assert 299_000 <= heard[0][0] - shown[0][0] < 302_000


@pytest.mark.parametrize("switch", [(0, 3), (9, 0), (0, 1), (0, 0)])
def test_each_switch_holds_the_stream(switch):
    host = Host(make_scene())
    host.write(*switch, 0)  # 9:0 is on after power-up
    host.switch_on(exclude=[switch])
    host.wait(300_000)
    assert host.data == b""
    host.write(*switch, 1)
    host.wait(300_000)
    assert host.listen().events == shifted(
        list_events(make_scene()), host.listener.events[0][0] - list_events(make_scene())[0][0]
    )


def test_events_and_frames_have_switches_of_their_own():
    for switch in [(1, 3), (2, 4)]:
        host = Host(make_scene())
        host.read_part()
        host.switch_on(exclude=[switch])
        host.wait(400_000)
        heard = host.listen()
        assert bool(heard.events) == (switch == (2, 4))
        assert bool(heard.frames) == (switch == (1, 3))


def test_frames_switched_on_and_off_at_once_are_one_frame():
    host = Host(make_scene())
    host.switch_on(exclude=[(2, 4)])
    for value in (0, 1, 0):
        host.write(2, 4, value)
    host.wait(400_000)
    heard = host.listen()
    assert heard.events
    assert len(heard.frames) == 1


def test_the_scene_stands_still_while_nobody_looks():
    scene = make_scene()
    host = Host(scene)
    host.switch_on()
    host.wait(80_000)
    for address in [(1, 3), (2, 4)]:
        host.write(*address, 0)
    host.wait(1_000_000)
    for address in [(1, 3), (2, 4)]:
        host.write(*address, 1)
    host.wait(400_000)
    heard = host.listen().events
    shown = list_events(scene)
    assert [event[1:] for event in heard] == [event[1:] for event in shown]
    late = [t for t, *_ in heard if t > 500_000]
    assert late
    assert late[0] >= 1_080_000


def test_a_quiet_camera_sends_a_wrap_every_33_ms():
    host = Host([])
    host.switch_on()
    host.wait(1_000_000)
    assert host.listen().wraps == [1] * 30


def test_time_goes_on_without_sensors_and_not_without_its_switch():
    host = Host([])
    host.queue()
    for address in [(0, 3), (9, 0), (0, 0)]:
        host.write(*address, 1)
    host.wait(500_000)
    assert not host.data
    host.write(0, 1, 1)
    host.wait(500_000)
    assert host.listen().wraps == [1] * 15


def test_sparse_data_waits_for_the_early_packet_delay_and_dense_data_does_not():
    packet = EventPacket(0, 100_000, make_scene(n_events=1)[0].events[:0])
    for cycles, delay_us in ((80_640, 1000), (20_160, 250)):
        host = Host([packet])
        host.write(9, 1, cycles)
        assert host.camera.registers.early_packet_delay_us == pytest.approx(delay_us)
        host.switch_on()
        host.wait(110_000, step_us=50)
        assert host.answers[0].length == 6  # three wraps, held until all transfers were queued
        host.answers.clear()
        spent = 0
        while not host.answers:
            host.wait(50, step_us=50)
            spent += 50
        assert (131_072 - 110_000) <= spent <= (131_072 - 110_000) + delay_us + 100
    dense = Host(make_scene(n_events=40_000))
    dense.switch_on()
    dense.wait(300_000)
    assert max(answer.length for answer in dense.answers) == 8192


def test_a_host_that_does_not_read_loses_events_and_is_told():
    scene = make_scene(n_events=20_000)
    host = Host(scene, CameraConfig(fifo_bytes=4096))
    host.read_part()
    host.write(0, 5, 1)
    host.switch_on()
    host.wait(50_000)
    for _ in range(80):  # time passes, nobody takes anything
        host.now_us += 1000
        host.camera.advance()
    host.wait(300_000)
    heard = host.listen()
    assert host.camera.n_dropped > 1000
    assert len(heard.events) + host.camera.n_dropped == 20_000
    for module, parameter in ((1, 85), (0, 83)):
        assert host.read(module, parameter) << 32 | host.read(module, parameter + 1) == (
            host.camera.n_dropped
        )
    assert max(heard.wraps) > 1
    assert set(heard.events) <= set(
        shifted(list_events(scene), heard.events[0][0] - list_events(scene)[0][0])
    )
    for frame in heard.frames:
        assert frame["end"] > frame["begin"]


def test_told_to_wait_it_loses_nothing():
    scene = make_scene(n_events=20_000, n_frames=0)
    host = Host(scene, CameraConfig(fifo_bytes=4096))
    host.read_part()
    host.write(0, 5, 0)
    host.switch_on()
    host.wait(50_000)
    for _ in range(80):
        host.now_us += 1000
        host.camera.advance()
    host.wait(400_000)
    assert host.camera.n_dropped == 0
    assert [event[1:] for event in host.listen().events] == [e[1:] for e in list_events(scene)]


def test_in_a_hurry_it_goes_as_fast_as_it_is_read_and_loses_nothing():
    scene = make_scene(n_events=100_000)
    host = Host(scene, CameraConfig(unpaced=True, lead_us=1000, fifo_bytes=1 << 17))
    host.switch_on()
    host.wait(105_000)
    while not host.camera.ended:
        host.wait(500)
    assert host.now_us < 150_000
    heard = host.listen()
    assert [event[1:] for event in heard.events] == [e[1:] for e in list_events(scene)]
    assert (
        heard.events[-1][0] - heard.events[0][0]
        == list_events(scene)[-1][0] - list_events(scene)[0][0]
    )
    assert len(heard.frames) == 3


def test_a_region_of_the_frame_is_taken_over_at_the_next_frame():
    host = Host(make_scene())
    host.switch_on()
    host.wait(100_000)
    for parameter, value in zip((8, 9, 10, 11), (100, 50, 107, 53), strict=True):
        host.write(2, parameter, value)
    host.wait(300_000)
    sizes = [frame["picture"].shape for frame in host.listen().frames]
    assert sizes == [(260, 346), (260, 346), (4, 8)]


def test_events_outside_of_their_region_and_silenced_pixels_are_not_sent():
    scene = make_scene()
    shown = list_events(scene)
    hot = shown[5][1:3]
    host = Host(scene)
    for parameter, value in zip((41, 42, 43, 44), (100, 50, 299, 199), strict=True):
        host.write(1, parameter, value)
    host.write(1, 11, hot[1])
    host.write(1, 12, hot[0])
    host.switch_on()
    host.wait(400_000)
    expected = [e[1:3] for e in shown if 100 <= e[1] < 300 and 50 <= e[2] < 200 and e[1:3] != hot]
    assert [event[1:3] for event in host.listen().events] == expected


def test_frames_come_no_faster_than_the_register_says():
    host = Host(make_scene(length_us=400_000, n_frames=7))
    host.write(2, 13, 30 * 1008 * 100)  # 100 ms
    host.read_part()
    host.switch_on()
    host.wait(600_000)
    begins = [frame["exposure_begin"] for frame in host.listen().frames]
    assert [b - a for a, b in pairwise(begins)] == [100_000] * 3


def test_the_motion_sensor_speaks_when_switched_on():
    host = Host([])
    for parameter in (2, 3, 4):
        host.write(3, parameter, 1)
    host.write(3, 7, 1)
    host.write(3, 10, 1)
    host.switch_on()
    host.wait(300_000)
    samples = host.listen().imu
    assert 290 <= len(samples) <= 301
    assert {len(sample["bytes"]) for sample in samples} == {15}
    assert samples[0]["bytes"][:7] == [0xE5, 0, 0, 0, 0, 0x20, 0]  # 1 g downwards at 4 g
    host.write(3, 2, 0)
    host.write(3, 3, 0)
    host.wait(50_000)
    assert len(host.listen().imu[-1]["bytes"]) == 3


def test_clear_halt_and_flush_drop_what_waits():
    for request in ((0x02, 1, 0, 0x82), (0x40, 0xC6, 0, 0)):
        host = Host(make_scene())
        for address in [(0, 3), (9, 0), (0, 1), (0, 0), (1, 3)]:
            host.write(*address, 1)
        host.now_us += 50_000
        host.camera.advance()
        host.write(0, 0, 0)
        host.request(*request)
        host.write(1, 3, 0)
        host.queue()
        host.write(0, 0, 1)
        host.wait(110_000)
        assert not host.listen().events


def test_without_them_the_next_driver_gets_stale_data():
    host = Host(make_scene())
    for address in [(0, 3), (9, 0), (0, 1), (0, 0), (1, 3)]:
        host.write(*address, 1)
    host.now_us += 50_000
    host.camera.advance()
    for address in [(1, 3), (0, 0)]:
        host.write(*address, 0)
    host.queue()
    host.write(0, 0, 1)
    host.wait(110_000)
    assert host.listen().events


def test_data_waits_until_all_transfers_are_queued():
    host = Host(make_scene())
    for address in [(0, 3), (9, 0), (0, 1), (0, 0), (1, 3)]:
        host.write(*address, 1)
    for _ in range(10):
        host.queue(1)
        host.now_us += 20_000
        assert not list(host.port.completions())
    host.now_us += 110_000
    assert list(host.port.completions())


@pytest.mark.parametrize("orientation", [0, 4, 5, 6, 7])
def test_every_orientation_shows_the_same_scene(orientation):
    scene = make_scene(n_frames=1, length_us=50_000)
    host = Host(scene, CameraConfig(orientation=orientation))
    size = (260, 346) if orientation & 4 else (346, 260)
    assert (host.read(1, 0), host.read(1, 1)) == (host.read(2, 0), host.read(2, 1)) == size
    assert host.read(1, 2) == host.read(2, 2) == orientation
    host.switch_on()
    host.wait(400_000)
    heard = host.listen()
    assert [event[1:] for event in heard.events] == [e[1:] for e in list_events(scene)]
    pictures = [frame.pixels for packet in scene for frame in packet.frames]
    for seen, shown in zip(heard.frames, pictures, strict=True):
        assert (seen["picture"] >> 2 == shown).all()
