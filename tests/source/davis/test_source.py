"""The camera as a source, on a scripted camera: start, faults, coming back, a slow consumer."""

import contextlib
import logging
import threading
import time
from dataclasses import replace
from itertools import islice, pairwise

import numpy as np
import pytest
import usb1

from neurotouch_hid.device import MemoryDevice
from neurotouch_hid.errors import CameraBusyError, CameraError, SourceError
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline, run_pipeline
from neurotouch_hid.source import PolledSource
from neurotouch_hid.source.camera_source import RETRY_S, PatientWatch
from neurotouch_hid.source.davis import Biases, DavisConfig, DavisSource, Roi
from neurotouch_hid.source.davis.registers import CoarseFine
from neurotouch_hid.source.davis.stream import IDLE_FRAME_S, MAX_FAULTS, PARTIAL_US
from neurotouch_hid.source.davis.transport import StreamHaltedError
from neurotouch_hid.source.davis.usb import Usb
from neurotouch_hid.source.slice_pacer import LONGEST_US
from tests.source.davis.camera import INFO, ScriptedCamera, gone, make_events
from tests.source.davis.words import pack
from tests.source.taking import take
from tests.waiting import wait_until


def open_camera(camera, *args, **options):
    """The driver with a scripted camera, which needs no time to settle."""
    return DavisSource(*args, cameras=camera, sleep_s=lambda _: None, **options)


def times(packets):
    return np.concatenate([packet.events["t"] for packet in packets]).tolist()


def assert_sound(packets):
    """Slices on one grid, in order, with their own events only; where one is missing, a gap."""
    for packet in packets:
        assert packet.t_end_us - packet.t_begin_us == 10_000
        assert packet.t_begin_us % 10_000 == 0
        t = packet.events["t"]
        assert (np.diff(t) >= 0).all()
        assert ((packet.t_begin_us <= t) & (t < packet.t_end_us)).all()
    for before, after in pairwise(packets):
        assert after.t_begin_us >= before.t_end_us
        assert after.gap or after.t_begin_us == before.t_end_us


def test_slices_of_a_running_camera():
    camera = ScriptedCamera()
    camera.at_reset.append([make_events(0, 51)])
    with open_camera(camera) as source:
        assert isinstance(source, PolledSource)
        assert source.name == "davis:00001055"
        packets = take(source, 5)
    assert_sound(packets)
    assert packets[0].t_begin_us == 0
    assert times(packets) == [1000 * ms + 1 for ms in range(50)]
    assert not any(packet.gap for packet in packets)
    assert camera.n_open == 0


def test_a_quiet_camera_gives_empty_slices_by_its_wraps():
    camera = ScriptedCamera()
    camera.at_reset.append([b"\x01\x70" * 3])  # 98 ms
    with open_camera(camera) as source:
        packets = take(source, 9)
    assert_sound(packets)
    assert packets[-1].t_end_us == 90_000
    assert not times(packets)


def test_data_may_wait_until_the_partial_slice_is_due_and_then_until_the_end():
    camera = ScriptedCamera()
    pieces = [(0, 3), (3, 6), (6, 8), (8, 9)]  # ms; the slices end at 4.25 and 8.5 ms
    camera.at_reset.append([make_events(*piece) for piece in pieces])
    with open_camera(camera, slice_us=4_250) as source:
        take(source, 1)
        while len(camera.rests) < 6:
            time.sleep(0.001)
    begins_s, untils_s = zip(*camera.rests[:6], strict=True)
    due_us = 8_500 - PARTIAL_US
    rests_s = [1e-6 * us for us in (due_us - 5_001, due_us - 7_001, 8_500 - 8_001)]
    for k, rest_s in enumerate(rests_s, start=3):
        assert begins_s[k - 1] + rest_s <= untils_s[k] <= begins_s[k] + rest_s


def test_data_of_a_short_slice_waits_until_its_end():
    camera = ScriptedCamera()
    camera.at_reset.append([make_events(0, 2)])
    with open_camera(camera, slice_us=1_000) as source:
        take(source, 1)
        while len(camera.rests) < 3:
            time.sleep(0.001)
    begins_s, untils_s = zip(*camera.rests[:3], strict=True)
    rest_s = 1e-6 * (2_000 - 1_001)
    assert begins_s[1] + rest_s <= untils_s[2] <= begins_s[2] + rest_s


def test_a_line_that_plays_gets_the_head_of_a_slice_before_its_end():
    camera = ScriptedCamera()
    camera.at_reset.append([make_events(0, 2), make_events(2, 4)])
    with open_camera(camera, slice_us=3_500) as source:
        source.set_activity(is_idle=False)
        polled = (packet for packet in source.poll() if packet is not None)
        head = next(polled)
        camera.script.append(make_events(4, 6))
        whole = next(polled)
    assert (head.t_begin_us, head.t_end_us, head.is_partial) == (0, 3_001, True)
    assert times([head]) == [1, 1_001, 2_001]
    assert (whole.t_begin_us, whole.t_end_us, whole.is_partial) == (0, 3_500, False)
    assert times([whole]) == [1, 1_001, 2_001, 3_001]


def test_a_line_that_is_idle_gets_heads_only_until_slices_wait():
    camera = ScriptedCamera()
    camera.at_reset.append([make_events(ms, ms + 2) for ms in range(0, 800, 2)])
    with open_camera(camera, slice_us=3_500) as source:
        source.set_activity(is_idle=True)
        for packet in filter(None, source.poll()):
            assert packet.t_end_us < 610_000 or not packet.is_partial
            if packet.t_begin_us > 610_000:
                break


def test_a_line_that_has_said_nothing_gets_whole_slices():
    camera = ScriptedCamera()
    camera.at_reset.append([make_events(ms, ms + 2) for ms in range(0, 40, 2)])
    with open_camera(camera, slice_us=3_500) as source:
        assert not any(packet.is_partial for packet in take(source, 10))


REST = [(2, 4, 0), (9, 1, 80_640)]  # no more frames; data waits for 1 ms of 80.64 MHz
SNAP = [(2, 4, 1), (2, 4, 0)]
WAKE = [(2, 4, 1), (9, 1, 20_160)]
BURST = pack("3005 " * 60)


def noise(piece_ms=4):
    """A stream of an event every ms, in pieces."""
    stream, size = make_events(0, 60_000), 6 * piece_ms
    return (stream[k : k + size] for k in range(0, len(stream), size))


def play_calm(camera, source, stream, until):
    """Takes slices as an idle line does that has seen the gel at rest."""
    deadline_s = time.monotonic() + 60.0
    for packet in source.poll():
        if packet is not None:
            source.set_activity(is_idle=True, wants_frames=False)
        if until():
            return
        assert time.monotonic() < deadline_s, asked(camera)
        if not camera.script:
            camera.script.append(next(stream))


def asked(camera):
    """What was written to it since its clock was reset."""
    log = camera.log
    return log[log.index((0, 2, 0)) + 1 :] if (0, 2, 0) in log else []


def test_a_camera_rests_while_nothing_happens_and_wakes_up_at_the_first_motion():
    camera, stream = ScriptedCamera(), noise()
    with open_camera(camera, slice_us=4_000) as source:
        play_calm(camera, source, stream, lambda: len(asked(camera)) >= 6)
        assert asked(camera)[:6] == [*REST, *SNAP, *SNAP]
        camera.script.append(BURST)
        play_calm(camera, source, stream, lambda: WAKE[1] in asked(camera))
        woke = asked(camera).index(WAKE[1])
        assert asked(camera)[woke - 1 : woke + 1] == WAKE


def test_a_camera_that_rests_is_read_when_joined_slices_are_due_or_more_than_noise_has_come():
    camera, stream = ScriptedCamera(), noise()
    with open_camera(camera, slice_us=4_000) as source:
        play_calm(camera, source, stream, lambda: len(asked(camera)) >= 2)
        del camera.rests[:]
        play_calm(camera, source, stream, lambda: len(camera.rests) >= 50)
        longest_s = max(until_s - begun_s for begun_s, until_s in camera.rests)
        assert 1e-6 * (LONGEST_US - 4_000) <= longest_s <= 1e-6 * (LONGEST_US + 4_000)
        assert 4 < camera.most_noise < 30  # 4 events a slice are usual
        camera.script.append(BURST)
        play_calm(camera, source, stream, lambda: WAKE[1] in asked(camera))
        play_calm(camera, source, stream, lambda: camera.most_noise == 0)


def play_motion(camera, source, stream, n):
    """The lengths of n slices after the first motion, in µs."""
    source.set_activity(is_idle=True)
    lengths_us, is_moving = [], False
    deadline_s = time.monotonic() + 60.0
    for packet in source.poll():
        assert time.monotonic() < deadline_s, lengths_us
        if not camera.script:  # what waits would come in whole slices
            camera.script.append(next(stream) + BURST * is_moving)
        if packet is None:
            continue
        is_moving = is_moving or packet.t_end_us > 60_000
        lengths_us += [packet.t_end_us - packet.t_begin_us] * is_moving
        if len(lengths_us) >= n:
            return lengths_us
    raise AssertionError("the source has ended")


def test_slices_come_in_parts_while_the_gel_moves():
    with open_camera(camera := ScriptedCamera(), slice_us=4_000, part_us=1_000) as source:
        assert play_motion(camera, source, noise(1), 60).count(1_000) > 20


def test_slices_of_a_chosen_length_stay_as_they_are():
    with open_camera(camera := ScriptedCamera(), slice_us=4_000) as source:
        assert set(play_motion(camera, source, noise(1), 30)[-10:]) == {4_000}


def test_a_pipeline_that_is_behind_gets_whole_slices():
    with open_camera(camera := ScriptedCamera(), slice_us=4_000, part_us=1_000) as source:
        play_motion(camera, source, stream := noise(1), 60)
        camera.script += [next(stream) + BURST for _ in range(60)]
        while camera.script:
            time.sleep(0.001)
        lengths_us = [packet.t_end_us - packet.t_begin_us for packet in take(source, 10)]
    assert lengths_us[-1] == 4_000


def test_a_resting_camera_that_does_not_answer_but_sends_is_asked_again():
    camera, stream = ScriptedCamera(), noise()

    def fail_once():
        camera.fail_at[camera.n_requests + 1] = CameraError("The camera does not answer.")

    with open_camera(camera, slice_us=4_000) as source:
        play_calm(camera, source, stream, lambda: asked(camera))
        fail_once()
        play_calm(camera, source, stream, lambda: len(asked(camera)) >= 4)
        assert asked(camera)[:4] == [*REST, *SNAP]
        fail_once()
        motion = (noise + BURST for noise in stream)
        play_calm(camera, source, motion, lambda: WAKE[1] in asked(camera))
        assert min(camera.fail_at) < max(camera.fail_at) < camera.n_requests
        assert (camera.n_opened, source.stats().trouble) == (1, "")


def test_a_camera_does_not_rest_while_its_frames_are_wanted():
    camera = ScriptedCamera()
    camera.at_reset.append(islice(noise(), 250))
    with open_camera(camera, slice_us=4_000) as source:
        for packet in source.poll():
            source.set_activity(is_idle=True)
            if packet is not None and packet.t_end_us > 900_000:
                break
        assert asked(camera) == []


def test_a_camera_without_frames_rests_without_frames():
    camera, stream = ScriptedCamera(), noise()
    with open_camera(camera, config=DavisConfig(frames=False), slice_us=4_000) as source:
        play_calm(camera, source, stream, lambda: len(asked(camera)) >= 2)
        begun_s = time.monotonic()
        play_calm(camera, source, stream, lambda: time.monotonic() > begun_s + 2 * IDLE_FRAME_S)
        camera.script.append(BURST)
        play_calm(camera, source, stream, lambda: len(asked(camera)) >= 4)
        assert asked(camera)[:4] == [*REST, (2, 4, 0), WAKE[1]]


def test_transfers_are_queued_before_anything_runs_and_the_clock_is_reset_last():
    camera = ScriptedCamera()
    camera.at_reset.append([make_events(0, 11)])
    with open_camera(camera) as source:
        take(source, 1)
    begin = camera.log.index("queue")
    started = [(0, 3, 1), (9, 0, 1), (0, 1, 1), (0, 0, 1), (1, 3, 1), (2, 4, 1), (0, 2, 1)]
    assert camera.log[begin + 1 : begin + 9] == [*started, (0, 2, 0)]
    silenced = [(1, 3, 0), (2, 4, 0), (3, 2, 0), (3, 3, 0), (3, 4, 0), (4, 0, 0), (4, 11, 0)]
    silenced += [(0, 0, 0), (0, 1, 0), (9, 0, 0), (0, 3, 0)]
    assert camera.log[: len(silenced)] == silenced
    assert camera.log[-len(silenced) :] == silenced


WORDS = {
    range(5): [0x019B, 0x0195, 0x01E0, 0x01C1, 0x01D5],
    range(8, 14): [0x5A4F, 0x7D7E, 0x427F, 0x5FFF, 0x401F, 0x690F],
    range(14, 21): [0x23AD, 0x110D, 0x419D, 0x614D, 0x6DBF, 0x514D, 0x001F],
    range(21, 28): [0x63CD, 0x531F, 0x65BF, 0x450D, 0x798D, 0x5FFF, 0x5FFF],
    range(34, 37): [0x5FEF, 0x8410, 0x8410],
}
"""What libcaer, neuromorphic-drivers and the vendor's library write to the biases."""


def test_the_default_settings_are_those_of_the_public_drivers():
    camera = ScriptedCamera()
    open_camera(camera).close()
    for addresses, words in WORDS.items():
        assert [camera.values[5, address] for address in addresses] == words
    chip = dict.fromkeys([*range(128, 136), 137, 140, 141, 144], 0)
    chip |= {136: 1, 138: 1, 142: 1, 143: 1}
    assert {p: camera.values[5, p] for p in chip} == chip
    assert camera.values[0, 4] == camera.values[0, 5] == camera.values[2, 5] == 1
    assert [camera.values[1, p] for p in range(11, 27)] == [260, 346] * 8
    assert [camera.values[1, p] for p in (4, 5, 31, 32, 33, 51, 61, 62)] == [0, 0, 1, 8, 0, 0, 0, 0]
    assert [camera.values[1, p] for p in range(41, 45)] == [0, 0, 345, 259]
    assert [camera.values[2, p] for p in range(7, 12)] == [1, 0, 0, 345, 259]
    assert camera.values[2, 12] == 120_960  # 4 ms of a clock of 30.24 MHz
    assert camera.values[2, 13] == 1_209_600  # 40 ms
    assert camera.values[9, 1] == 20_160  # 250 µs of 80.64 MHz


def test_every_setting_reaches_its_register():
    camera = ScriptedCamera()
    config = DavisConfig(
        exposure_us=1000,
        frame_interval_us=20_000,
        early_packet_delay_us=125,
        activity_filter_us=0,
        refractory_us=600,
        hot_pixels=((3, 4),),
        events_roi=Roi(1, 2, 300, 200),
        frames_roi=Roi(5, 6, 105, 206),
        frames=False,
        biases=Biases(OnBn=CoarseFine(6, 7)),
    )
    camera.at_reset.append([make_events(0, 11)])
    with open_camera(camera, config=config) as source:
        take(source, 1)
        assert camera.values[2, 4] == 0
    assert camera.values[2, 12] == 30_240
    assert camera.values[2, 13] == 604_800
    assert camera.values[9, 1] == 10_080
    assert [camera.values[1, p] for p in (31, 33, 34)] == [0, 1, 3]
    assert [camera.values[1, p] for p in (11, 12, 13, 14)] == [4, 3, 260, 346]
    assert [camera.values[1, p] for p in range(41, 45)] == [1, 2, 300, 200]
    assert [camera.values[2, p] for p in range(8, 12)] == [5, 6, 105, 206]
    assert camera.values[5, 11] == 0x607F


@pytest.mark.parametrize("flag", [(1, 10), (1, 30), (1, 40), (1, 50), (1, 60)])
def test_a_filter_that_is_not_there_is_not_written(flag):
    camera = ScriptedCamera({flag: 0})
    open_camera(camera).close()
    first = flag[1] + 1
    assert not any(entry[:2] == (1, first) for entry in camera.log)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"exposure_us": 0}, "exposure_us must be 1 to 4194303, not 0"),
        ({"hot_pixels": ((346, 0),)}, "x of a hot pixel must be 0 to 345"),
        ({"hot_pixels": ((0, 0),) * 9}, "number of hot_pixels"),
        ({"frames_roi": Roi(10, 0, 9, 5)}, "frames_roi is not inside the picture"),
        ({"biases": Biases(OnBn=CoarseFine(8, 0))}, "coarse value of OnBn"),
    ],
)
def test_settings_no_camera_can_have_are_refused(options, words):
    with pytest.raises(CameraError, match=words):
        DavisConfig(**options)


@pytest.mark.parametrize(
    ("values", "info", "words"),
    [
        ({(6, 0): 17}, {}, "logic version 17; this driver needs version 18"),
        ({(6, 7): 0}, {}, "logic patch 0; this driver needs patch 1"),
        ({(6, 1): 3}, {}, "chip DAVIS128; this driver needs DAVIS346B"),
        ({(6, 1): 77}, {}, "unknown chip, number 77"),
        (
            {(1, 0): 240, (1, 1): 180},
            {},
            "sensor 180×240 pixels; this driver needs 346×260 pixels for",
        ),
        ({}, {"firmware": 5}, "firmware version 5; this driver needs version 6"),
    ],
)
def test_another_camera_is_refused_and_given_back(values, info, words):
    camera = ScriptedCamera(values, [make_info(**info)])
    with pytest.raises(CameraError, match=words) as caught:
        open_camera(camera)
    assert caught.value.exit_code == 3
    assert "does not flash" in caught.value.hint
    assert camera.n_open == 0


def make_info(**changes):
    return replace(INFO, **changes)


def test_usb_2_works_and_warns(caplog):
    camera = ScriptedCamera(infos=[make_info(speed_mbit_s=480)])
    camera.at_reset.append([make_events(0, 11)])
    with open_camera(camera) as source:
        assert take(source, 1)
    assert "00001055 runs at the speed of USB 2" in caplog.text


def test_two_cameras_by_serial():
    other = make_info(serial="00002066", address=6)
    camera = ScriptedCamera(infos=[INFO, other])
    with open_camera(camera, "00002066") as source:
        assert source.name == "davis:00002066"
    with pytest.raises(CameraError, match="No camera 7"):
        open_camera(camera, "7")


def test_without_a_choice_the_camera_that_played_is_preferred():
    camera = ScriptedCamera(infos=[INFO])
    camera.at_reset.extend([[make_events(0, 31), gone()], [make_events(0, 31)]])
    with open_camera(camera) as source:
        camera.infos.insert(0, make_info(serial="00000001", address=4))
        polled = source.poll()
        wait_until(lambda: (next(polled), source.stats().n_connects)[1] == 2)
        assert source.stats().serial == INFO.serial


def test_a_busy_camera_is_refused_with_its_own_exit_code():
    camera = ScriptedCamera()
    camera.open = raise_(CameraBusyError("The camera is in use by PID 1."))
    with pytest.raises(CameraBusyError) as caught:
        open_camera(camera)
    assert caught.value.exit_code == 75
    assert isinstance(caught.value, SourceError)


def raise_(error):
    def call(*_):
        raise error

    return call


def test_half_an_answer_is_refused():
    class Curt(ScriptedCamera):
        def request(self, code, value, index, data):
            return super().request(code, value, index, data)[:2]

    camera = Curt()
    with pytest.raises(CameraError, match="2 bytes instead of 4"):
        open_camera(camera)
    assert camera.n_open == 0


def count_requests_of_an_open():
    camera = ScriptedCamera()
    open_camera(camera).close()
    return camera.n_requests


@pytest.mark.parametrize("error", [CameraError("timed out"), gone()], ids=["time-out", "unplug"])
def test_a_request_that_fails_anywhere_while_opening_gives_the_camera_back(error):
    n = count_requests_of_an_open()
    assert n > 100
    for k in range(1, n + 1, 7):
        camera = ScriptedCamera()
        camera.fail_at = {k: error}
        with contextlib.suppress(CameraError):
            open_camera(camera).close()
        assert camera.n_open == 0


@pytest.mark.parametrize("k", range(1, 60, 5))
def test_a_camera_that_fails_at_any_stage_is_opened_again(k):
    """Requests of the first start, of streaming, of a second start; then all is well."""
    camera = ScriptedCamera()
    camera.at_reset.extend([[make_events(0, 21), gone()]] + 3 * [[make_events(0, 21)]])
    source = open_camera(camera)
    camera.fail_at = {camera.n_requests + k: CameraError("timed out")}
    with source:
        packets = take(source, 4)
    assert_sound(packets)
    assert camera.n_opened >= 2
    assert camera.n_open == 0


def test_after_unplugging_the_slices_go_on_later_with_a_gap():
    camera = ScriptedCamera()
    camera.at_reset.extend([[make_events(0, 35), gone()], [make_events(0, 35)]])
    with open_camera(camera) as source:
        packets = take(source, 6)
        assert source.stats().n_connects == 2
        assert source.stats().connected
    assert_sound(packets)
    assert [packet.gap for packet in packets] == [0, 0, 0, 1, 0, 0]
    assert packets[3].t_begin_us > packets[2].t_end_us
    assert len(times(packets)) == 60


def test_who_reads_hears_of_a_failure_without_a_wait(monkeypatch):
    monkeypatch.setattr("neurotouch_hid.source.camera_source.POLL_S", 10_000.0)
    camera = ScriptedCamera()
    camera.at_reset.append([make_events(0, 21), camera.infos.clear, gone()])
    with open_camera(camera) as source:
        polled = source.poll()
        while next(polled) is not None:
            pass
        assert "camera" in source.trouble


def test_while_it_is_away_the_loop_turns_and_can_be_ended(caplog):
    camera = ScriptedCamera()
    camera.at_reset.append([make_events(0, 21), camera.infos.clear, gone()])
    with open_camera(camera) as source:
        polled = source.poll()
        wait_until(lambda: next(polled) is not None)
        wait_until(lambda: "No camera" in source.stats().trouble)
        while next(polled) is not None:
            pass
        assert next(polled) is None
        assert not source.stats().connected
        camera.infos.append(INFO)
        wait_until(lambda: source.stats().connected)
    assert list(polled) == []
    assert caplog.messages == [
        "The camera is gone. The gamepad works again as soon as the camera does.",
        "The camera 00001055 plays.",
    ]
    assert {record.levelno for record in caplog.records} == {logging.WARNING}


class BrokenCamera(ScriptedCamera):
    """Fails ``n_failures`` times, each time at its start.

    ``waits`` counts the waits before each start. In the wait ``replug_at`` it is replugged, which
    mends it.
    """

    def __init__(self, n_failures, replug_at=0):
        super().__init__()
        self.n_failures, self.replug_at = n_failures, replug_at
        self.waits = [0]

    def queue(self, receive):
        super().queue(receive)
        self.waits.append(0)
        if self.n_failures:
            self.n_failures -= 1
            self.script.append(CameraError("The camera's data makes no sense."))
        else:
            self.script.append(make_events(0, 500))

    def wait(self, timeout_s):
        assert timeout_s == RETRY_S
        self.waits[-1] += 1
        if sum(self.waits) == self.replug_at:
            self.infos[0] = replace(INFO, address=INFO.address + 1)
            self.n_failures = 0


FAILS = "The camera's data makes no sense. "
FAILS_FIRST = f"{FAILS}The gamepad works again as soon as the camera does."
FAILS_AGAIN = (
    f"{FAILS}It fails again and again, so it is started again less and less often, "
    "at least every 30 s."
)
PLAYS = "The camera 00001055 plays."


def test_a_camera_that_stays_broken_is_started_less_and_less_often(caplog, monkeypatch):
    monkeypatch.setattr("neurotouch_hid.source.camera_source.WELL_US", 200_000)
    camera = BrokenCamera(n_failures=9)
    with open_camera(camera) as source:
        take(source, 1)
        pauses_s = [n * RETRY_S for n in camera.waits[1:10]]
        assert pauses_s == [0.5, 1, 2, 4, 8, 16, 30, 30, 30]
        wait_until(lambda: len(caplog.messages) == 4)  # after it has played for a while
        assert caplog.messages == [FAILS_FIRST, PLAYS, FAILS_AGAIN, PLAYS]
        camera.script.append(CameraError("The camera's data makes no sense."))
        wait_until(lambda: source.stats().n_connects == 11)
        assert camera.waits[10] == 1  # this failure is the first one again
        assert caplog.messages[4:] == [FAILS_FIRST, PLAYS]


def test_a_broken_camera_that_is_replugged_is_started_at_once(caplog):
    camera = BrokenCamera(n_failures=20, replug_at=1 + 2 + 4 + 3)
    with open_camera(camera) as source:
        take(source, 1)
    assert camera.waits[1:5] == [1, 2, 4, 3]
    assert caplog.messages == [FAILS_FIRST, PLAYS, FAILS_AGAIN, PLAYS]


def test_a_source_that_waits_needs_no_camera_at_the_start():
    camera = ScriptedCamera(infos=[])
    with pytest.raises(CameraError):
        open_camera(camera)
    camera.at_reset.append([make_events(0, 21)])
    with open_camera(camera, wait=True) as source:
        polled = source.poll()
        assert next(polled) is None
        camera.infos.append(INFO)
        assert next(packet for packet in polled if packet is not None).t_begin_us == 0
        assert source.stats().serial == "00001055"


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_bug_in_the_thread_does_not_let_the_line_wait_for_ever():
    camera = ScriptedCamera()
    camera.at_reset.append([ZeroDivisionError()])
    with open_camera(camera) as source, pytest.raises(CameraError, match="bug in the driver"):
        list(source)
    assert camera.n_open == 0


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_thread_that_cannot_begin_does_not_let_the_line_wait_for_ever():
    camera = ScriptedCamera()
    camera.watch = raise_(ZeroDivisionError())
    with open_camera(camera) as source, pytest.raises(CameraError, match="bug in the driver"):
        take(source, 1)
    assert camera.n_open == 0


def test_a_source_that_is_closed_before_its_thread_plays_gives_the_camera_back():
    camera = ScriptedCamera()
    source = open_camera(camera)

    def watch_late():
        assert source._closing.wait(60.0)
        return PatientWatch()

    camera.watch = watch_late
    next(source.poll())
    source.close()
    assert camera.n_open == 0


def test_where_libusb_cannot_listen_the_camera_is_looked_for_all_the_same(monkeypatch):
    """As when no more files may be open."""
    monkeypatch.setattr(usb1.USBContext, "open", raise_(usb1.USBErrorOther(-99)))
    watch = Usb().watch()
    watch.wait(0.0)
    watch.close()


def test_close_ends_an_iteration_in_another_thread():
    source = open_camera(ScriptedCamera())
    ended = threading.Thread(target=lambda: list(source))
    ended.start()
    time.sleep(0.05)
    source.close()
    ended.join(20)
    assert not ended.is_alive()
    source.close()


def test_a_source_that_was_never_played_gives_the_camera_back():
    camera = ScriptedCamera()
    source = open_camera(camera)
    assert camera.n_open == 1
    source.close()
    assert camera.n_open == 0


def test_a_stalled_stream_is_set_going_again_with_a_gap():
    camera = ScriptedCamera()
    stall = [b"", StreamHaltedError("stalled")]
    camera.at_reset.append([make_events(0, 15), *stall, make_events(15, 41)])
    with open_camera(camera) as source:
        packets = take(source, 4)
        assert source.stats().n_connects == 1
        assert source.stats().n_faults == 1
    assert_sound(packets)
    assert [packet.gap for packet in packets] == [0, 1, 0, 0]
    assert camera.n_queued == 2


def test_a_stream_that_stalls_again_and_again_is_opened_anew():
    camera = ScriptedCamera()
    stall = [b"", StreamHaltedError("The camera's stream has stalled.")]
    camera.at_reset.extend([stall * 3, [make_events(0, 11)]])
    with open_camera(camera) as source:
        (packet,) = take(source, 1)
        assert source.stats().n_connects == 2
    assert packet.gap
    assert camera.n_queued == 4


def test_transfers_that_fail_leave_gaps_and_in_the_end_a_new_start():
    camera = ScriptedCamera()

    def fail():  # at once, whatever else the machine does
        for _ in range(MAX_FAULTS - 1):
            camera.receive(b"")

    camera.at_reset.extend([[make_events(0, 5), b"", make_events(5, 11), fail], []])
    with open_camera(camera) as source:
        (packet,) = take(source, 1)
        wait_until(lambda: source.stats().n_connects == 2)
        assert source.stats().n_faults == MAX_FAULTS
    assert packet.gap == 1
    assert times([packet]) == [1000 * ms + 1 for ms in range(10)]


def test_what_the_camera_drops_is_a_gap():
    camera = ScriptedCamera({(1, 86): 2**32 - 5, (0, 84): 7})

    def overflow():
        camera.values[1, 86] = 10  # 15 later: the counter has run over
        camera.values[0, 84] = 8

    camera.at_reset.append([make_events(0, 15), overflow])
    with open_camera(camera) as source:
        first = take(source, 1)
        wait_until(lambda: source.stats().n_dropped)
        camera.script.append(make_events(15, 31))
        packets = first + take(source, 2)
    assert [packet.gap for packet in packets] == [0, 15, 0]


def test_a_count_that_is_not_answered_does_not_end_the_stream():
    camera = ScriptedCamera()
    camera.at_reset.append([make_events(0, 15)])
    source = open_camera(camera)
    with source:
        first = take(source, 1)
        n = camera.n_requests
        camera.fail_at = {n + 1: CameraError("timed out"), n + 2: CameraError("timed out")}
        wait_until(lambda: camera.n_requests >= n + 2 or camera.script.append(b"\x01\x70"))
        camera.script.append(make_events(15, 31))
        assert source.stats().n_connects == 1
    assert_sound(first)


def test_a_timestamp_reset_in_mid_stream_is_a_gap_and_time_goes_on():
    camera = ScriptedCamera()
    camera.at_reset.append([make_events(0, 15), b"\x01\x00", make_events(0, 31)])
    with open_camera(camera) as source:
        packets = take(source, 4)
    assert_sound(packets)
    assert sum(packet.gap for packet in packets) == 1
    assert times(packets)[14:17] == [14_001, 14_002, 15_002]


def test_stale_data_before_the_reset_is_dropped():
    camera = ScriptedCamera()
    camera.script.append(make_events(100, 500))
    camera.at_reset.append([make_events(0, 11)])
    with open_camera(camera) as source:
        (packet,) = take(source, 1)
    assert times([packet]) == [1000 * ms + 1 for ms in range(10)]


def test_odd_transfers_are_put_together():
    camera = ScriptedCamera()
    data = make_events(0, 21)
    camera.at_reset.append([data[k : k + 7] for k in range(0, len(data), 7)])
    with open_camera(camera) as source:
        packets = take(source, 2)
    assert times(packets) == [1000 * ms + 1 for ms in range(20)]


def test_a_slow_consumer_loses_the_oldest_and_is_told_how_much():
    camera = ScriptedCamera()
    camera.at_reset.append([make_rest(ms) for ms in range(0, 1000, 10)])
    with open_camera(camera) as source:
        polled = source.poll()
        packets = [next(polled)]
        wait_until(lambda: not (camera.script or camera.at_reset))
        n_pumped = len(camera.rests)
        wait_until(lambda: len(camera.rests) > n_pumped + 1)  # the last of it is through
        packets += [next(polled) for _ in range(11)]
    packets = [packet for packet in packets if packet is not None]
    assert len(packets) in (10, 11)  # the first one too, if it was there
    assert_sound(packets)
    assert packets[-1].t_end_us == 990_000
    assert len(times(packets)) + sum(packet.gap for packet in packets) == 990


def make_rest(ms):
    """The next 10 ms of a stream, with only the wraps that fall into it."""
    return make_events(0, ms + 10)[len(make_events(0, ms)) :]


def test_a_silent_camera_is_opened_anew():
    camera = ScriptedCamera()
    camera.silent = True
    camera.at_reset.extend([[make_events(0, 11)], [make_events(0, 11)]])
    with open_camera(camera) as source:
        packets = take(source, 2)
        assert source.stats().n_connects >= 2
    assert packets[1].gap
    assert packets[1].t_begin_us >= 2_000_000


def test_a_driver_that_had_no_time_to_look_blames_no_camera():
    camera = ScriptedCamera()
    camera.at_reset.append([make_events(0, 11), lambda: time.sleep(2.1), make_rest(11)])
    with open_camera(camera) as source:
        packets = take(source, 2)
        assert source.stats().n_connects == 1
    assert_sound(packets)
    assert not any(packet.gap for packet in packets)


def test_the_line_goes_neutral_when_the_camera_falls_silent_and_ends_on_demand(push):
    """The stream of a push, up to the hold; then silence, then the end."""
    held = [packet for packet in push.packets if packet.t_end_us <= 1_500_000]

    class Silent(DavisSource):
        def poll(self):
            yield from held
            while not stop.is_set():
                time.sleep(0.01)
                yield None

    camera, device, stop, seen = ScriptedCamera(), MemoryDevice(), threading.Event(), []

    def look(step):
        if step.packet is held[-1]:
            seen.append(device.states[-1])
            threading.Thread(target=wait_and_stop).start()

    def wait_and_stop():
        wait_until(lambda: device.states[-1].is_neutral and len(turned) > 150)
        seen.append(device.states[-1])
        stop.set()

    line = Pipeline.build(load_profile("spacecraft"), GestureConfig())
    turned = []
    with Silent(cameras=camera) as source:
        stats = run_pipeline(
            source, line, device, [look], stop=stop, on_round=lambda: turned.append(1)
        )
    assert stats.slices == 150
    assert len(turned) > 150
    assert not seen[0].is_neutral
    assert seen[1].is_neutral
