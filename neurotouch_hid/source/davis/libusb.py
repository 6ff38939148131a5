"""USB through libusb1: many transfers in flight, so that no data waits for Python."""

import contextlib
import logging
import time
from collections.abc import Iterator
from typing import Any, Final

import usb1

from neurotouch_hid.errors import CameraBusyError, CameraError
from neurotouch_hid.process.finalizers import skip_finalizers
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
DRAIN_S: Final = 5.0
"""A cancelled transfer comes back within milliseconds; Linux has lost one that takes this long."""

_abandoned: list["LibusbTransport"] = []
"""Kept for ever: Linux may still write to their transfers."""

log = logging.getLogger(__name__)


@contextlib.contextmanager
def _explained(what: str) -> Iterator[None]:
    """Turns libusb's errors into ours."""
    try:
        yield
    except usb1.USBError as error:
        raise _explain(error, what) from error


def _explain(error: usb1.USBError, what: str) -> CameraError:
    if isinstance(error, usb1.USBErrorNoDevice):
        return CameraGoneError("The camera is gone.")
    if isinstance(error, usb1.USBErrorBusy):
        return CameraBusyError("Another program uses the camera.")
    if isinstance(error, usb1.USBErrorAccess):
        hint = "Install the rule for it: neurotouch setup"
        return CameraError(f"The camera cannot be {what}: no right to use it.", hint=hint)
    return CameraError(f"The camera cannot be {what}: {error}.")


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
        self._transfers: list[Any] = []
        self._in_flight = 0
        self._ending = self._gone = self._halted = False
        self._closing = contextlib.ExitStack()
        try:
            with _explained("opened"):
                self._context = self._closing.enter_context(usb1.USBContext())
                self._handle = self._open(bus, address)
                self._closing.callback(self._handle.close)
                if self._handle.getConfiguration() != 1:
                    self._handle.setConfiguration(1)
                self._handle.claimInterface(INTERFACE)
                self._closing.callback(self._release)
        except CameraError:
            self._closing.close()
            raise

    def request(self, code: int, value: int, index: int, data: bytes | int) -> bytes:
        """Makes one vendor request."""
        with _explained(f"asked (request 0x{code:02X}, {value}:{index})"):
            if isinstance(data, int):
                answer = self._handle.controlRead(REQUEST_IN, code, value, index, data, TIMEOUT_MS)
                return bytes(answer)
            self._handle.controlWrite(REQUEST_OUT, code, value, index, data, TIMEOUT_MS)
            return b""

    def queue(self, receive: Receive) -> None:
        """Clears the endpoint and submits all transfers."""
        if not self._drain():
            raise CameraError("The camera's transfers do not come back.")
        self._receive = receive
        self._halted = False
        with _explained("read"):
            self._handle.clearHalt(ENDPOINT)
            while len(self._transfers) < N_TRANSFERS:
                transfer = self._handle.getTransfer()
                transfer.setBulk(ENDPOINT, TRANSFER_BYTES, self._complete)
                self._transfers.append(transfer)
            for transfer in self._transfers:
                transfer.submit()
                self._in_flight += 1

    def pump(self, timeout_s: float, rest_until_s: float) -> None:
        """Handles libusb's events; sleeps first, because the transfers keep arriving data."""
        rest_s = rest_until_s - time.monotonic()
        if rest_s > 0:
            time.sleep(rest_s)
        try:  # no context manager: this runs thousands of times a second
            self._context.handleEventsTimeout(timeout_s)
        except usb1.USBErrorInterrupted:
            pass
        except usb1.USBError as error:
            raise _explain(error, "read") from error
        if self._gone:
            raise CameraGoneError("The camera is gone.")
        if self._halted:
            raise StreamHaltedError("The camera's stream has stalled.")

    def close(self) -> None:
        """Cancels all transfers, waits for each one's callback, and closes.

        A camera whose transfers do not come back stays open: closing it would wait for them.
        """
        if self._drain():
            self._closing.close()
            return
        _abandon(self)
        log.warning(
            "Linux does not give back %d of the camera's transfers. Unplug the camera, and plug "
            "it in again.",
            self._in_flight,
        )

    def _open(self, bus: int, address: int) -> Any:
        for device in self._context.getDeviceIterator(skip_on_error=True):
            if (device.getBusNumber(), device.getDeviceAddress()) == (bus, address):
                return device.open()
        raise CameraGoneError("The camera is gone.")

    def _release(self) -> None:
        with contextlib.suppress(usb1.USBError):  # the camera is gone, and its claim too
            self._handle.releaseInterface(INTERFACE)

    def _complete(self, transfer: Any) -> None:
        """Handles an ended transfer; libusb calls it within ``pump`` or a request."""
        self._in_flight -= 1
        status, length = transfer.getStatus(), transfer.getActualLength()
        if length:  # also of one that was cancelled or has failed
            self._receive(bytes(transfer.getBuffer()[:length]))
        if status == usb1.TRANSFER_CANCELLED:
            return
        self._gone |= status == usb1.TRANSFER_NO_DEVICE
        if status != usb1.TRANSFER_COMPLETED and not (self._halted or self._gone):
            self._receive(b"")  # once for a stall, which ends them all
        self._halted |= status == usb1.TRANSFER_STALL
        if not (self._ending or self._gone or self._halted):
            try:
                transfer.submit()
                self._in_flight += 1
            except usb1.USBErrorNoDevice:
                self._gone = True
            except usb1.USBError:
                self._halted = True

    def _drain(self) -> bool:
        """Cancels transfers in flight and waits for them: libusb writes to them until then.

        Returns:
            Whether all of it has come back.
        """
        self._ending = True
        for transfer in self._transfers:
            with contextlib.suppress(usb1.USBError):  # not in flight, or gone
                transfer.cancel()
        deadline_s = time.monotonic() + DRAIN_S
        while self._in_flight and time.monotonic() < deadline_s:
            with contextlib.suppress(usb1.USBError):
                self._context.handleEventsTimeout(0.1)
        self._ending = self._in_flight > 0
        return not self._in_flight


def _abandon(transport: LibusbTransport) -> None:
    """Never closes it, not even at exit, where usb1 would wait for ever."""
    _abandoned.append(transport)
    skip_finalizers(usb1.__name__)


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
