"""USB through libusb1: many transfers in flight, so that no data waits for Python.

The transport calls libusb's own functions. The classes of ``usb1`` would enter Python for each
transfer, which takes four times as long as all that is done here.
"""

import contextlib
import logging
import time
from collections import deque
from ctypes import byref, c_char, c_int, create_string_buffer
from typing import Any, Final, NamedTuple

import usb1

from neurotouch_hid.errors import CameraBusyError, CameraError
from neurotouch_hid.source.camera_errors import CameraGoneError
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
WAKE_S: Final = 60e-6
"""The thread wakes up this time before data is needed. What has come by then is not enough."""
DRAIN_S: Final = 5.0
"""A cancelled transfer comes back within milliseconds; Linux has lost one that takes this long."""

_libusb: Final = usb1.libusb1
_IN_FLIGHT: Final = -1
"""Status of a transfer that has not ended; libusb writes another one."""

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


class _Transfer(NamedTuple):
    """A transfer: the pointer to it, its structure, and the memory for its data."""

    pointer: Any
    fields: Any
    data: Any


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
        self._transfers: list[_Transfer] = []
        self._in_flight: deque[_Transfer] = deque()  # in the order in which they will end
        self._ending = self._gone = self._halted = False
        self._closing = contextlib.ExitStack()
        self._context, self._handle = _libusb.libusb_context_p(), _libusb.libusb_device_handle_p()
        self._wait = _libusb.timeval()
        try:
            _require(_libusb.libusb.libusb_init(byref(self._context)), "opened")
            self._closing.callback(_libusb.libusb_exit, self._context)
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
        while len(self._transfers) < N_TRANSFERS:
            self._transfers.append(self._make_transfer())
        for transfer in self._transfers:
            _require(self._submit(transfer), "read")

    def pump(self, timeout_s: float, rest_until_s: float) -> None:
        """Handles libusb's events; sleeps first, because the transfers keep arriving data."""
        rest_s = rest_until_s - WAKE_S - time.monotonic()
        if rest_s > 0:
            time.sleep(rest_s)
        if not self._take_ended():  # else a request has handled their events
            self._await_transfers(timeout_s)
        if rest_s > 0 and time.monotonic() < rest_until_s:
            self._await_transfers(timeout_s)
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
            while self._transfers:
                _libusb.libusb_free_transfer(self._transfers.pop().pointer)
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

    def _make_transfer(self) -> _Transfer:
        """Returns a transfer without a callback: its status says that it has ended."""
        pointer, data = _libusb.libusb_alloc_transfer(0), (c_char * TRANSFER_BYTES)()
        none = _libusb.libusb_transfer_cb_fn_p()
        _libusb.libusb_fill_bulk_transfer(
            pointer, self._handle, ENDPOINT, data, TRANSFER_BYTES, none, None, 0
        )
        return _Transfer(pointer, pointer.contents, data)

    def _submit(self, transfer: _Transfer) -> int:
        transfer.fields.status = _IN_FLIGHT
        result: int = _libusb.libusb_submit_transfer(transfer.pointer)
        if not result:
            self._in_flight.append(transfer)
        return result

    def _await_transfers(self, timeout_s: float) -> None:
        """Waits until a transfer ends, unless one has ended, and takes all that have."""
        try:
            self._handle_events(timeout_s)
        finally:  # data from before the failure is good
            if not self._take_ended():
                self._pass_over_lost()

    def _handle_events(self, timeout_s: float) -> None:
        self._wait.tv_usec = round(1e6 * timeout_s)
        result = _libusb.libusb_handle_events_timeout(self._context, byref(self._wait))
        if result and result != usb1.ERROR_INTERRUPTED:
            _require(result, "read")

    def _take_ended(self) -> bool:
        """Takes the transfers that have ended; returns whether there are any."""
        in_flight, has_any = self._in_flight, False
        while in_flight and in_flight[0].fields.status != _IN_FLIGHT:
            self._complete(in_flight.popleft())
            has_any = True
        return has_any

    def _pass_over_lost(self) -> None:
        """Takes transfers that have ended before older ones, and waits for the older ones last.

        Linux ends the transfers of an endpoint in order, so it has lost the older ones.
        """
        in_flight = self._in_flight
        ended = (k for k, each in enumerate(in_flight) if each.fields.status != _IN_FLIGHT)
        if n_lost := next(ended, 0):
            in_flight.rotate(-n_lost)
            self._take_ended()

    def _complete(self, transfer: _Transfer) -> None:
        """Passes on the data of an ended transfer, and submits it again."""
        status, length = transfer.fields.status, transfer.fields.actual_length
        if length:  # also of one that was cancelled or has failed
            self._receive(transfer.data[:length])
        if status == usb1.TRANSFER_CANCELLED:
            return
        if status != usb1.TRANSFER_COMPLETED:
            self._gone |= status == usb1.TRANSFER_NO_DEVICE
            if not (self._halted or self._gone):
                self._receive(b"")  # once for a stall, which ends them all
            self._halted |= status == usb1.TRANSFER_STALL
        if self._ending or self._gone or self._halted:
            return
        if result := self._submit(transfer):
            self._gone |= result == usb1.ERROR_NO_DEVICE
            self._halted |= result != usb1.ERROR_NO_DEVICE

    def _drain(self) -> bool:
        """Cancels transfers in flight and waits for them: libusb writes to them until then.

        Returns:
            Whether all of it has come back.
        """
        self._ending = True
        for transfer in self._in_flight:
            _libusb.libusb_cancel_transfer(transfer.pointer)  # or it has ended, or is gone
        deadline_s = time.monotonic() + DRAIN_S
        while self._in_flight and time.monotonic() < deadline_s:
            with contextlib.suppress(CameraError):
                self._handle_events(0.1)
            for _ in range(len(self._in_flight)):  # in any order
                transfer = self._in_flight.popleft()
                if transfer.fields.status == _IN_FLIGHT:
                    self._in_flight.append(transfer)
                else:
                    self._complete(transfer)
        self._ending = bool(self._in_flight)
        return not self._in_flight


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
