"""Which transfers a read takes."""

from types import SimpleNamespace

import pytest
import usb1

from neurotouch_hid.source.davis import libusb


class Scripted(libusb.LibusbTransport):
    """Transfers 0 to 3, then new ones, submitted again and again.

    ``ends`` has those that end at each look.
    """

    def __init__(self, *ends):
        self.received, self.ends = [], list(ends)
        self._receive = self.received.append
        self._ending = self._gone = self._halted = False
        self._in_flight = libusb.deque()
        self._transfers = []
        for _ in range(4):
            self._submit(self._make_transfer())

    def _make_transfer(self):
        ended = SimpleNamespace(status=usb1.TRANSFER_COMPLETED, actual_length=0)
        self._transfers.append(libusb._Transfer(None, ended, b"%d" % len(self._transfers)))
        return self._transfers[-1]

    def _submit(self, transfer):
        transfer.fields.status = libusb._IN_FLIGHT
        self._in_flight.append(transfer)
        return 0

    def _handle_events(self, timeout_s):
        for k in self.ends.pop(0):
            fields = self._transfers[k].fields
            fields.status, fields.actual_length = usb1.TRANSFER_COMPLETED, 1


@pytest.mark.parametrize(("late_s", "n"), [(0.0, 3), (0.001, 2)])
def test_data_from_before_waits_for_the_next_unless_the_thread_wakes_late(monkeypatch, late_s, n):
    now_s = 0.0

    def sleep(rest_s):
        nonlocal now_s
        now_s += rest_s + late_s

    clock = SimpleNamespace(monotonic=lambda: now_s, sleep=sleep)
    monkeypatch.setattr(libusb, "time", clock)
    transport = Scripted([0, 1], [2])
    transport.pump(0.05, 0.004)
    assert transport.received == [b"0", b"1", b"2"][:n]


def test_data_that_is_needed_at_once_waits_for_nothing():
    transport = Scripted([0, 1], [2])
    transport.pump(0.05, 0.0)
    assert transport.received == [b"0", b"1"]


def test_transfers_whose_end_a_request_has_seen_are_taken_without_a_wait():
    transport = Scripted([0])
    transport._handle_events(0.0)
    transport.pump(0.05, 0.0)
    assert transport.received == [b"0"]


@pytest.mark.parametrize(
    ("ends", "received"),
    [
        ([[1, 2], [3, 4, 1]], [b"", b"1", b"2", b"3", b"4", b"1"]),
        ([[2], [3, 4, 5, 2]], [b"", b"", b"2", b"3", b"4", b"5", b"2"]),
        ([[3], [4, 5, 6, 3]], [b"", b"", b"", b"3", b"4", b"5", b"6", b"3"]),
        ([[0, 3], [0], [4]], [b"0", b"", b"", b"3", b"0", b"4"]),
    ],
)
def test_lost_transfers_are_missing_data_and_new_ones_replace_them(ends, received):
    transport = Scripted(*ends)
    while transport.ends:
        transport.pump(0.05, 0.0)
    assert transport.received == received
    assert len(transport._in_flight) == 4
