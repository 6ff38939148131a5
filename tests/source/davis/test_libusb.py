"""Which transfers a read takes: the compiled loop on transfers of libusb, without a camera."""

from ctypes import CFUNCTYPE, POINTER, c_int, c_long, c_void_p

import numpy as np
import pytest
import usb1

from neurotouch_hid.process.c_call import find_address
from neurotouch_hid.process.kernel_cache import bind
from neurotouch_hid.source.camera_errors import CameraGoneError
from neurotouch_hid.source.davis import libusb
from neurotouch_hid.source.davis.kernels.transfers import Calls, make_transfers, pump
from neurotouch_hid.source.davis.transport import ANY_TIME, LOOK_US, StreamHaltedError

N = 4
REST_S = 0.004
"""Data is needed then; the clock begins at 0."""
LOOK_S = 1e-6 * LOOK_US
EVENT, SAMPLE = b"\x06\x30", b"\x07\x40"


class Scripted(libusb.LibusbTransport):
    """Transfers 0 to 3, submitted again and again; ``ends`` has those that end at each look.

    Transfer k brings the digit k, or the k-th of ``words``.
    """

    def __init__(self, *ends, late_s=0.0, words=()):
        usb1.loadLibrary()
        self.received, self.ends, self.words = [], list(ends), words
        self.now_ns, self.late_ns, self.refuses = 0, round(1e9 * late_s), 0
        self._receive = self.received.append
        self._ending = self._gone = self._halted = False
        self._pointers = []
        self._transfers = make_transfers(N, 8)
        self._in_flight = np.arange(N)
        self._handle = None
        for _ in range(N):
            self._add_transfer()
            self._pointers[-1].contents.status = -1
        self._kept = self._make_calls()  # or Python frees what C still calls
        memcpy = libusb.ctypes.CDLL(None).memcpy
        clock, sleep, handle_events, submit = map(find_address, self._kept)
        calls = Calls(clock, sleep, find_address(memcpy), handle_events, submit, 0)
        self._pump = bind(pump, calls, self._transfers)

    def _make_calls(self):
        @CFUNCTYPE(c_int, c_long, POINTER(c_long))
        def clock(_, times):
            times[0], times[1] = divmod(self.now_ns, 1_000_000_000)
            return 0

        @CFUNCTYPE(c_int, c_long, c_long, POINTER(c_long), c_void_p)
        def sleep(_clock, _flags, times, _left):
            self.now_ns = max(self.now_ns, 1_000_000_000 * times[0] + times[1]) + self.late_ns
            return 0

        @CFUNCTYPE(c_int, c_void_p, c_void_p)
        def handle_events(*_):
            self.now_ns += 50_000
            for k in self.ends.pop(0):
                self.end(k)
            return 0

        @CFUNCTYPE(c_int, c_void_p)
        def submit(_):
            return self.refuses

        return clock, sleep, handle_events, submit

    def end(self, k, status=usb1.TRANSFER_COMPLETED):
        fields, data = self._pointers[k].contents, self.words[k] if self.words else b"%d" % k
        self._transfers.data[k, : len(data)] = list(data)
        fields.actual_length, fields.status = len(data), status

    def read(self, rest_s=0.0, time_word=ANY_TIME, most_noise=0):
        self.pump(0.05, rest_s, time_word, most_noise)

    def received_at_once(self):
        return b"".join(self.received).decode()


def test_data_that_is_needed_at_once_waits_for_nothing_more():
    transport = Scripted([0, 1], [2])
    transport.read()
    assert transport.received == [b"01"]


def test_transfers_whose_end_a_request_has_seen_are_taken_without_a_wait():
    transport = Scripted()
    transport.end(0)
    transport.read()
    assert transport.received == [b"0"]


@pytest.mark.parametrize(("time", "n"), [(0xFE, 1), (0xFF, 1), (0x7FFF, 1), (0x100, 2), (0x101, 3)])
def test_a_read_goes_on_until_the_time_that_is_needed_has_come(time, n):
    words = b"\xff\x80\x05\x30", b"\x00\x81\x06\x30", b"\x01\x81"  # times 0xFF to 0x101
    transport = Scripted([0], [1], [2], words=words)
    transport.read(REST_S, time)
    assert transport.received == [b"".join(words[:n])]


def test_a_time_that_does_not_come_is_not_waited_for_much_longer():
    transport = Scripted(*[[0], [1], [2], [3]] * 8)
    transport.read(REST_S, 0x100)
    assert REST_S + 0.0003 <= 1e-9 * transport.now_ns < REST_S + 0.0004


def test_more_than_a_read_can_take_stays_in_order():
    words = [bytes([0, 0x81]) * 3 + bytes([k, 0x30]) for k in range(N)]
    transport = Scripted([0, 1, 2, 3], [0, 1, 2], [3], words=words)
    transport.read(REST_S, 0x101)
    assert transport.received == [b"".join(words)]
    transport.read()
    transport.read()
    assert transport.received[1:] == [b"".join(words[:3]), words[3]]


def test_a_thread_that_wakes_late_takes_what_is_there():
    transport = Scripted([1], late_s=0.001)
    transport.end(0)
    transport.read(REST_S, 0x100)
    assert transport.received == [b"01"]


@pytest.mark.parametrize(("word", "n_looks"), [(EVENT, 3), (SAMPLE, 6)])
def test_a_long_rest_ends_when_more_events_come_than_noise_makes(word, n_looks):
    transport = Scripted([0], [1], [2, 3], [], [0], [1], words=[word] * N)
    transport.read(6 * LOOK_S, most_noise=1)
    assert len(transport.ends) == 6 - n_looks
    assert abs(1e-9 * transport.now_ns - n_looks * LOOK_S) < 0.001


def test_a_long_rest_ends_with_data_that_has_just_come():
    transport = Scripted([0], [1], [2], words=[EVENT] * N)
    transport.read(2.9 * LOOK_S, most_noise=1)
    assert transport.received == [EVENT * 3]


def test_a_long_rest_ends_when_a_transfer_fails():
    transport = Scripted([], [0], [2], words=[EVENT] * N)
    transport.end(1, usb1.TRANSFER_ERROR)
    transport._submit = lambda number: 0
    transport.read(100 * LOOK_S, most_noise=9)
    assert transport.received == [EVENT, EVENT, b""]
    assert len(transport.ends) == 1


def test_a_rest_without_noise_does_not_look():
    transport = Scripted([0])
    transport.read(10 * LOOK_S)
    assert not transport.ends
    assert transport.received == [b"0"]


@pytest.mark.parametrize(
    ("ends", "received"),
    [
        ([[1, 2], [3, 1], [2]], "12312"),
        ([[2], [3, 2], [3]], "2323"),
        ([[3], [3], [3]], "333"),
        ([[0, 3], [0], [3, 0]], "03030"),
    ],
)
def test_lost_transfers_do_not_hold_up_the_others_and_stay_in_flight(ends, received):
    transport = Scripted(*ends)
    while transport.ends:
        transport.read()
    assert transport.received_at_once() == received
    assert len(transport._in_flight) == N


def test_a_transfer_that_ends_late_is_used_again():
    transport = Scripted([2], [3, 0, 1], [2, 3, 0, 1])
    while transport.ends:
        transport.read()
    assert transport.received_at_once() == "23012301"


def test_a_transfer_that_has_failed_is_told_after_the_data_before_it():
    transport = Scripted([0])
    transport.end(1, usb1.TRANSFER_ERROR)
    transport._submit = lambda number: 0
    transport.read()
    assert transport.received == [b"0", b"1", b""]


@pytest.mark.parametrize(
    ("error", "raised"),
    [(usb1.ERROR_NO_DEVICE, CameraGoneError), (usb1.ERROR_IO, StreamHaltedError)],
)
def test_a_camera_that_takes_no_transfer_back_is_an_error_after_its_data(error, raised):
    transport = Scripted([0, 1])
    transport.refuses, transport._drain = error, lambda: True
    with pytest.raises(raised):
        transport.read()
    assert transport.received[0] == b"0"


def test_a_long_rest_ends_before_there_is_no_room():
    transport = Scripted([0, 1], [2], [3], words=[SAMPLE * 4] * N)
    transport.read(100 * LOOK_S, most_noise=9)
    assert transport.received == [SAMPLE * 12]
