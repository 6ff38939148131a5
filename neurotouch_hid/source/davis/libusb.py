"""USB through libusb1: many transfers in flight, so that no data waits for Python.

The transport calls libusb's own functions, and those of the stream from compiled code: the classes
of ``usb1`` would enter Python for each transfer.
"""

import contextlib
import ctypes
import logging
import time
from collections.abc import Callable
from ctypes import byref, c_int, create_string_buffer
from typing import Any, Final

import numpy as np
import usb1

from neurotouch_hid.errors import CameraBusyError, CameraError
from neurotouch_hid.process.c_call import find_address
from neurotouch_hid.process.kernel_cache import bind
from neurotouch_hid.source.camera_errors import CameraGoneError
from neurotouch_hid.source.davis.kernels.transfers import (
    COMPLETED,
    IN_FLIGHT,
    Calls,
    make_transfers,
    pump,
)
from neurotouch_hid.source.davis.registers import (
    ENDPOINT,
    INTERFACE,
    PRODUCT_ID,
    REQUEST_IN,
    REQUEST_OUT,
    VENDOR_ID,
)
from neurotouch_hid.source.davis.transport import (
    TIMEOUT_MS,
    Receive,
    StreamHaltedError,
)

N_TRANSFERS: Final = 128
TRANSFER_BYTES: Final = 8_192
"""A multiple of 1024, USB 3's packet, or a full packet too much would be an error. A sparse stream
ends its transfers early; a dense one of 31 MB/s, 5 million events/s with frames, fills one in
0.3 ms, and all of them bridge 34 ms in which Python does not come."""
DRAIN_S: Final = 5.0
"""A cancelled transfer comes back within milliseconds; Linux has lost one that takes this long."""

_libusb: Final = usb1.libusb1
_abandoned: list["LibusbTransport"] = []
"""Kept for ever: Linux may still write to their transfers."""

log = logging.getLogger(__name__)


def _require(result: int, what: str) -> int:
    """Returns a result of libusb, or raises our error for it."""
    if result >= 0:
        return result
    if result == usb1.ERROR_NO_DEVICE:
        raise CameraGoneError("The camera is gone.")
    if result == usb1.ERROR_BUSY:
        raise CameraBusyError("Another program uses the camera.")
    if result == usb1.ERROR_ACCESS:
        hint = "Install the rule for it: neurotouch setup"
        raise CameraError(f"The camera cannot be {what}: no right to use it.", hint=hint)
    raise CameraError(f"The camera cannot be {what}: {usb1.USBError(result)}.")


class LibusbTransport:
    """A camera in a libusb context of its own, so libusb's device list is never out of date.

    A driver that lives for months must not depend on libusb's list of devices, which follows
    udev's messages and misses changes where these cannot be received.

    Args:
        bus: where the camera is, as Linux counts.
        address: the same.

    Raises:
        CameraGoneError: it is not there.
        CameraBusyError: another program has claimed it.
        CameraError: it cannot be opened.
    """

    def __init__(self, bus: int, address: int) -> None:
        self._receive: Receive = len
        self._pointers: list[Any] = []  # to the transfers
        self._transfers = make_transfers(N_TRANSFERS, TRANSFER_BYTES)
        self._in_flight = np.empty(0, np.int64)  # in the order in which they will end
        self._ending = self._gone = self._halted = False
        self._closing = contextlib.ExitStack()
        self._context, self._handle = _libusb.libusb_context_p(), _libusb.libusb_device_handle_p()
        self._wait = _libusb.timeval()
        try:
            _require(_libusb.libusb.libusb_init(byref(self._context)), "opened")
            self._closing.callback(_libusb.libusb_exit, self._context)
            self._pump = self._bind_pump()
            self._open(bus, address)
            self._closing.callback(_libusb.libusb_close, self._handle)
            number = c_int()
            _require(_libusb.libusb_get_configuration(self._handle, byref(number)), "opened")
            if number.value != 1:
                _require(_libusb.libusb_set_configuration(self._handle, 1), "opened")
            _require(_libusb.libusb_claim_interface(self._handle, INTERFACE), "opened")
            self._closing.callback(_libusb.libusb_release_interface, self._handle, INTERFACE)
        except CameraError:
            self._closing.close()
            raise

    def request(self, code: int, value: int, index: int, data: bytes | int) -> bytes:
        """Makes one vendor request."""
        is_read, given = isinstance(data, int), bytes(data)  # so many zeros, if it is a number
        buffer = create_string_buffer(given, len(given))
        n = _libusb.libusb_control_transfer(
            self._handle,
            REQUEST_IN if is_read else REQUEST_OUT,
            code,
            value,
            index,
            buffer,
            len(given),
            TIMEOUT_MS,
        )
        _require(n, f"asked (request 0x{code:02X}, {value}:{index})")
        return buffer.raw[:n] if is_read else b""

    def queue(self, receive: Receive) -> None:
        """Clears the endpoint and submits all transfers."""
        if not self._drain():
            raise CameraError("The camera's transfers do not come back.")
        self._receive = receive
        self._halted = False
        _require(_libusb.libusb_clear_halt(self._handle, ENDPOINT), "read")
        while len(self._pointers) < N_TRANSFERS:
            self._add_transfer()
        for number in range(N_TRANSFERS):
            _require(self._submit(number), "read")

    def pump(self, timeout_s: float, rest_until_s: float, time_word: int, most_noise: int) -> None:
        """Handles libusb's events; sleeps first, because the transfers keep arriving data."""
        n_bytes, error = self._pump(
            self._in_flight,
            round(1e6 * timeout_s),
            round(1e9 * rest_until_s),
            time_word,
            most_noise,
        )
        if n_bytes:
            self._receive(self._transfers.taken[:n_bytes].tobytes())
        while len(self._in_flight) and self._find_status(self._in_flight[0]) > COMPLETED:
            failed, self._in_flight = self._in_flight[0], self._in_flight[1:]
            self._complete(failed)
        _require(error, "read")
        if self._gone:
            self._drain()  # some transfers may have been filled before
            raise CameraGoneError("The camera is gone.")
        if self._halted:
            raise StreamHaltedError("The camera's stream has stalled.")

    def close(self) -> None:
        """Cancels all transfers, waits until each one has ended, and closes.

        A camera whose transfers do not come back stays open: closing it would wait for them.
        """
        if self._drain():
            while self._pointers:
                _libusb.libusb_free_transfer(self._pointers.pop())
            self._closing.close()
            return
        _abandoned.append(self)
        log.warning(
            "Linux does not give back %d of the camera's transfers. Unplug the camera, and plug "
            "it in again.",
            len(self._in_flight),
        )

    def _open(self, bus: int, address: int) -> None:
        devices = _libusb.libusb_device_p_p()
        n = _require(_libusb.libusb_get_device_list(self._context, byref(devices)), "opened")
        try:
            for device in devices[:n]:
                number = _libusb.libusb_get_bus_number(device)
                if (number, _libusb.libusb_get_device_address(device)) == (bus, address):
                    _require(_libusb.libusb_open(device, byref(self._handle)), "opened")
                    return
        finally:
            _libusb.libusb_free_device_list(devices, 1)
        raise CameraGoneError("The camera is gone.")

    def _bind_pump(self) -> Callable[..., tuple[int, int]]:
        c = ctypes.CDLL(None)
        called = (
            c.clock_gettime,
            c.clock_nanosleep,
            c.memcpy,
            _libusb.libusb_handle_events_timeout,
            _libusb.libusb_submit_transfer,
            self._context,
        )
        return bind(pump, Calls(*map(find_address, called)), self._transfers)

    def _add_transfer(self) -> None:
        """Makes a transfer without a callback: its status says that it has ended."""
        pointer, number = _libusb.libusb_alloc_transfer(0), len(self._pointers)
        data, none = self._transfers.data[number], _libusb.libusb_transfer_cb_fn_p()
        _libusb.libusb_fill_bulk_transfer(
            pointer, self._handle, ENDPOINT, data.ctypes.data, len(data), none, None, 0
        )
        kind, address = _libusb.libusb_transfer, find_address(pointer)
        offsets = 0, kind.status.offset, kind.actual_length.offset
        self._transfers.addresses[number] = [address + offset for offset in offsets]
        self._pointers.append(pointer)

    def _submit(self, number: int | np.int64) -> int:
        self._pointers[number].contents.status = IN_FLIGHT
        result: int = _libusb.libusb_submit_transfer(self._pointers[number])
        if not result:
            self._in_flight = np.append(self._in_flight, number)
        return result

    def _find_status(self, number: np.int64) -> int:
        status: int = self._pointers[number].contents.status
        return status

    def _handle_events(self, timeout_s: float) -> None:
        self._wait.tv_usec = round(1e6 * timeout_s)
        result = _libusb.libusb_handle_events_timeout(self._context, byref(self._wait))
        if result and result != usb1.ERROR_INTERRUPTED:
            _require(result, "read")

    def _complete(self, number: np.int64) -> None:
        """Passes on the data of an ended transfer, and submits it again."""
        fields = self._pointers[number].contents
        status, length = fields.status, fields.actual_length
        if length:  # also of one that was cancelled or has failed
            self._receive(self._transfers.data[number, :length].tobytes())
        if status == usb1.TRANSFER_CANCELLED:
            return
        if status != usb1.TRANSFER_COMPLETED:
            self._gone |= status == usb1.TRANSFER_NO_DEVICE
            if not (self._halted or self._gone):
                self._receive(b"")  # once for a stall, which ends them all
            self._halted |= status == usb1.TRANSFER_STALL
        if self._ending or self._gone or self._halted:
            return
        if result := self._submit(number):
            self._gone |= result == usb1.ERROR_NO_DEVICE
            self._halted |= result != usb1.ERROR_NO_DEVICE

    def _drain(self) -> bool:
        """Cancels transfers in flight and waits for them: libusb writes to them until then.

        Returns:
            Whether all of it has come back.
        """
        self._ending = True
        for number in self._in_flight:
            _libusb.libusb_cancel_transfer(self._pointers[number])  # or it has ended, or is gone
        deadline_s = time.monotonic() + DRAIN_S
        while len(self._in_flight) and time.monotonic() < deadline_s:
            with contextlib.suppress(CameraError):
                self._handle_events(0.1)
            has_ended = [self._find_status(number) != IN_FLIGHT for number in self._in_flight]
            ended = self._in_flight[has_ended]  # in any order
            self._in_flight = self._in_flight[np.logical_not(has_ended)]
            for number in ended:
                self._complete(number)
        self._ending = len(self._in_flight) > 0
        return not self._ending


class LibusbWatch:
    """Wakes up when a camera is plugged in or out, as soon as libusb reports it."""

    def __init__(self) -> None:
        self._closing = contextlib.ExitStack()
        self._context = self._closing.enter_context(usb1.USBContext())
        if usb1.hasCapability(usb1.CAP_HAS_HOTPLUG):
            self._context.hotplugRegisterCallback(
                _note, flags=0, vendor_id=VENDOR_ID, product_id=PRODUCT_ID
            )

    def wait(self, timeout_s: float) -> None:
        """Returns at the next change, or after the timeout."""
        try:
            self._context.handleEventsTimeout(timeout_s)
        except usb1.USBError:  # a libusb that cannot listen any more still lets time pass
            time.sleep(timeout_s)

    def close(self) -> None:
        """Stops listening."""
        self._closing.close()


def _note(*_: Any) -> bool:
    """Does nothing: libusb allows no request here, and the call itself ends the wait."""
    return False
