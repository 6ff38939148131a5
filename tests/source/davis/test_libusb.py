"""Which transfers a read takes."""

from types import SimpleNamespace

import pytest
import usb1

from neurotouch_hid.source.davis import libusb


class Scripted(libusb.LibusbTransport):
    """Transfers 0 to 3, submitted again and again; ``ends`` has those that end at each look."""

    def __init__(self, *ends):
        self.received, self.ends = [], list(ends)
        self._receive = self.received.append
        self._ending = self._gone = self._halted = False
        self._in_flight = libusb.deque()
        fields = [SimpleNamespace(actual_length=1) for _ in range(4)]
        self.transfers = [libusb._Transfer(None, f, b"%d" % k) for k, f in enumerate(fields)]
        for transfer in self.transfers:
            self._submit(transfer)

    def _submit(self, transfer):
        transfer.fields.status = libusb._IN_FLIGHT
        self._in_flight.append(transfer)
        return 0

    def _handle_events(self, timeout_s):
        for k in self.ends.pop(0):
            self.transfers[k].fields.status = usb1.TRANSFER_COMPLETED


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
        ([[1, 2], [3, 1], [2]], "12312"),
        ([[2], [3, 2], [3]], "2323"),
        ([[3], [3], [3]], "333"),
        ([[0, 3], [0], [3, 0]], "03030"),
    ],
)
def test_lost_transfers_do_not_hold_up_the_others_and_stay_in_flight(ends, received):
    transport = Scripted(*ends)
    while transport.ends:
        transport.pump(0.05, 0.0)
    assert b"".join(transport.received).decode() == received
    assert len(transport._in_flight) == 4


def test_a_transfer_that_ends_late_is_used_again():
    transport = Scripted([2], [3, 0, 1], [2, 3, 0, 1])
    while transport.ends:
        transport.pump(0.05, 0.0)
    assert transport.received == [b"2", b"3", b"0", b"1", b"2", b"3", b"0", b"1"]
