"""Compiled loop that waits for libusb's transfers, takes their data, and submits them again.

Python would take 10 µs for each transfer. Here it is entered when the data of a slice has come.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.c_call import call_c
from neurotouch_hid.process.kernel_cache import kernel, load
from neurotouch_hid.source.davis.kernels.decode import COLUMN_OFF, WRAP_US
from neurotouch_hid.source.davis.transport import ANY_TIME, LOOK_US

Numbers = NDArray[np.int64]
Bytes = NDArray[np.uint8]

IN_FLIGHT, COMPLETED, STALLED, GONE = -1, 0, 4, 5
"""States of a transfer: ours, for one that has not ended, and those of libusb."""

_NO_DEVICE, _INTERRUPTED = -4, -10  # errors of libusb
_MONOTONIC, _ABSOLUTE = 1, 1  # clock and flag of Linux
_INT_BYTES = 4
_SECOND_NS, _SECOND_US = 1_000_000_000, 1_000_000
_LOOK_NS = 1_000 * LOOK_US
_WAKE_NS = 60_000
"""The thread wakes up this time before data is needed. What has come by then is not enough."""
_PATIENCE_NS = 300_000
"""It waits this long for the time that is needed: at rest words are rare."""


class Calls(NamedTuple):
    """Addresses of the functions of C that are called, and libusb's context."""

    clock_gettime: int
    clock_nanosleep: int
    memcpy: int
    handle_events: int
    submit: int
    context: int


class Transfers(NamedTuple):
    """The transfers of a stream.

    Attributes:
        addresses: (n, 3) int64, of each transfer, of its status and of its length.
        data: (n, bytes) uint8 that they write to.
        taken: (n * bytes,) uint8, what was taken.
        word: (1,) int32, what is copied from a transfer or to it. An array of the kernel would be
            freed before a call that only has its address.
    """

    addresses: Numbers
    data: Bytes
    taken: Bytes
    word: NDArray[np.int32]


def make_transfers(n: int, n_bytes: int) -> Transfers:
    """Returns n transfers of as many bytes, without their addresses."""
    return Transfers(
        np.zeros((n, 3), np.int64),
        np.empty((n, n_bytes), np.uint8),
        np.empty(n * n_bytes, np.uint8),
        np.empty(1, np.int32),
    )


@kernel
def pump(
    calls: Calls,
    transfers: Transfers,
    in_flight: Numbers,
    timeout_us: int,
    rest_until_ns: int,
    time_word: int,
    most_noise: int,
) -> tuple[int, int]:
    """Sleeps, waits for transfers to end, and takes them.

    One that was taken is in flight again, behind the others. One that has failed is left in front.

    Args:
        calls: what is called.
        transfers: all transfers.
        in_flight: (m,) int64, numbers of those in flight, in the order in which they will end.
        timeout_us: how long to wait for a transfer.
        rest_until_ns: no data is needed before this time of the monotonic clock.
        time_word: time of the camera up to which data is needed then, 15 bits; or ANY_TIME.
        most_noise: if not 0, the rest ends as soon as more events come in ``LOOK_US``.

    Returns:
        How many bytes were taken, and 0 or an error of libusb.
    """
    times = np.empty(2, np.int64)
    result = begin = end = 0
    while most_noise:
        now_ns = _read_clock(calls, times)
        if now_ns + _LOOK_NS >= rest_until_ns:
            break
        _sleep(calls, times, now_ns + _LOOK_NS)
        times[0] = times[1] = 0
        result = call_c(calls.handle_events, (calls.context, times.ctypes.data))
        begin, end = end, _take(calls, transfers, in_flight, end)
        is_over = result != 0 or end > len(transfers.taken) // 2
        is_over = is_over or _count_events(transfers.taken[begin:end]) > most_noise
        if is_over or _has_failed(calls, transfers, in_flight):
            return end, 0 if result == _INTERRUPTED else result
    _sleep(calls, times, rest_until_ns - _WAKE_NS)
    begin, end = end, _take(calls, transfers, in_flight, end)
    is_enough = begin < end and _has_come(transfers.taken[begin:end], time_word)
    while not (is_enough or _has_failed(calls, transfers, in_flight)):
        times[0], times[1] = timeout_us // _SECOND_US, timeout_us % _SECOND_US
        result = call_c(calls.handle_events, (calls.context, times.ctypes.data))
        begin, end = end, _take(calls, transfers, in_flight, end)
        if begin == end:
            _pass_over_lost(calls, transfers, in_flight)
            end = _take(calls, transfers, in_flight, end)
        is_late = _read_clock(calls, times) >= rest_until_ns + _PATIENCE_NS
        has_none = begin == end or result != 0
        is_enough = is_late or has_none or _has_come(transfers.taken[begin:end], time_word)
    return end, 0 if result == _INTERRUPTED else result


def load_pump() -> None:
    """Compiles or loads ``pump``, before a camera's data waits for it."""
    in_flight = np.empty(0, np.int64)
    load(pump, Calls(0, 0, 0, 0, 0, 0), make_transfers(0, 0), in_flight, 0, 0, 0, 0)


@kernel
def _read_clock(calls: Calls, times: Numbers) -> int:
    """Returns the time of the monotonic clock in ns; ``times`` is written."""
    call_c(calls.clock_gettime, (_MONOTONIC, times.ctypes.data))
    now_ns: int = _SECOND_NS * times[0] + times[1]
    return now_ns


@kernel
def _sleep(calls: Calls, times: Numbers, until_ns: int) -> None:
    """Sleeps until a time of the monotonic clock; ``times`` is written."""
    times[0], times[1] = until_ns // _SECOND_NS, until_ns % _SECOND_NS
    call_c(calls.clock_nanosleep, (_MONOTONIC, _ABSOLUTE, times.ctypes.data, 0))


@kernel
def _take(calls: Calls, transfers: Transfers, in_flight: Numbers, end: int) -> int:
    """Takes those in front that are complete; returns how many bytes were taken so far."""
    n, size = 0, transfers.data.shape[1]
    while n < len(in_flight) and end + size <= len(transfers.taken):
        number = in_flight[n]
        transfer, status_at, length_at = transfers.addresses[number]
        if _read(calls, transfers, status_at) != COMPLETED:
            break
        length = _read(calls, transfers, length_at)
        transfers.taken[end : end + length] = transfers.data[number, :length]
        end += length
        _write(calls, transfers, status_at, IN_FLIGHT)
        error = call_c(calls.submit, (transfer,))
        if error:
            _write(calls, transfers, length_at, 0)
            _write(calls, transfers, status_at, GONE if error == _NO_DEVICE else STALLED)
            break
        n += 1
    _move_back(in_flight, n)
    return end


@kernel
def _has_failed(calls: Calls, transfers: Transfers, in_flight: Numbers) -> bool:
    """Returns True if the transfer in front has failed, or could not be submitted again."""
    if not len(in_flight):
        return False
    status: int = _read(calls, transfers, transfers.addresses[in_flight[0], 1])
    return status > COMPLETED


@kernel
def _pass_over_lost(calls: Calls, transfers: Transfers, in_flight: Numbers) -> None:
    """Moves transfers back that have not ended before younger ones.

    Linux ends the transfers of an endpoint in order, so it has lost them. They are waited for last.
    """
    for n in range(len(in_flight)):
        if _read(calls, transfers, transfers.addresses[in_flight[n], 1]) != IN_FLIGHT:
            _move_back(in_flight, n)
            return


@kernel
def _move_back(in_flight: Numbers, n: int) -> None:
    """Puts the first n behind the others."""
    if n:
        in_flight[:] = np.concatenate((in_flight[n:], in_flight[:n]))


@kernel
def _count_events(data: Bytes) -> int:
    """Returns how many events there are: each has a column word of its own."""
    n = 0
    for k in range(1, len(data), 2):
        n += data[k] & 0xE0 == COLUMN_OFF << 4  # the lowest bit of the code is the polarity
    return n


@kernel
def _has_come(data: Bytes, time_word: int) -> bool:
    """Returns True if any data will do, or the last time in it is not before that of the word."""
    if time_word == ANY_TIME:
        return True
    for k in range(len(data) - 1, 0, -2):
        if data[k] & 0x80:  # the high byte of a time
            word = np.int64(data[k]) << 8 | np.int64(data[k - 1])
            return bool((word - time_word) % WRAP_US < WRAP_US // 2)
    return False


@kernel
def _read(calls: Calls, transfers: Transfers, address: int) -> int:
    call_c(calls.memcpy, (transfers.word.ctypes.data, address, _INT_BYTES))
    number: int = transfers.word[0]
    return number


@kernel
def _write(calls: Calls, transfers: Transfers, address: int, number: int) -> None:
    transfers.word[0] = number
    call_c(calls.memcpy, (address, transfers.word.ctypes.data, _INT_BYTES))
