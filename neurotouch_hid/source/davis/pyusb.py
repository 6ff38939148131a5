"""USB through pyusb, where libusb1 cannot be loaded.

It keeps one read in flight, so a busy camera may lose events between two reads.
"""

import contextlib
import errno
from collections.abc import Iterator

import usb.core
import usb.util

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

TRANSFER_BYTES = 65_536
"""Large, because every read costs a gap; a sparse stream ends it early anyway."""
READ_MS = 200
"""No shorter, because a read that times out may lose data; a camera sends something every 33 ms."""


@contextlib.contextmanager
def _explained(what: str) -> Iterator[None]:
    """Turns pyusb's errors into ours."""
    try:
        yield
    except usb.core.NoBackendError as error:
        raise CameraError(
            "Neither libusb1 nor pyusb finds libusb.", hint="Debian: apt install libusb-1.0-0"
        ) from error
    except usb.core.USBError as error:
        if error.errno == errno.ENODEV:
            raise CameraGoneError("The camera is gone.") from error
        if error.errno == errno.EBUSY:
            raise CameraBusyError("Another program uses the camera.") from error
        if error.errno == errno.EPIPE and what == "read":
            raise StreamHaltedError("The camera's stream has stalled.") from error
        if error.errno == errno.EACCES:
            raise CameraError(
                f"The camera cannot be {what}: no right to use it.",
                hint="Install the rule for it: neurotouch setup",
            ) from error
        raise CameraError(f"The camera cannot be {what}: {error.strerror}.") from error


class PyusbTransport:
    """A camera through pyusb.

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
        with _explained("opened"):
            self._device = usb.core.find(
                idVendor=VENDOR_ID, idProduct=PRODUCT_ID, bus=bus, address=address
            )
            if self._device is None:
                raise CameraGoneError("The camera is gone.")
            try:
                if self._device.get_active_configuration().bConfigurationValue != 1:
                    self._device.set_configuration(1)
                usb.util.claim_interface(self._device, INTERFACE)
            except usb.core.USBError:
                usb.util.dispose_resources(self._device)
                raise

    def request(self, code: int, value: int, index: int, data: bytes | int) -> bytes:
        """Makes one vendor request."""
        kind = REQUEST_IN if isinstance(data, int) else REQUEST_OUT
        with _explained(f"asked (request 0x{code:02X}, {value}:{index})"):
            answer = self._device.ctrl_transfer(kind, code, value, index, data, TIMEOUT_MS)
        return bytes(answer) if isinstance(data, int) else b""

    def queue(self, receive: Receive) -> None:
        """Clears the endpoint; data waits in the camera until ``pump`` asks for it."""
        self._receive = receive
        with _explained("set going"):
            self._device.clear_halt(ENDPOINT)

    def pump(self, timeout_s: float, *_: float) -> None:
        """Reads once, immediately: nothing else buffers the data."""
        try:
            with _explained("read"):
                wait_ms = max(READ_MS, round(1e3 * timeout_s))
                data = self._device.read(ENDPOINT, TRANSFER_BYTES, wait_ms)
        except CameraGoneError:
            raise
        except StreamHaltedError:
            self._receive(b"")
            raise
        except CameraError as error:
            if not isinstance(error.__cause__, usb.core.USBTimeoutError):
                self._receive(b"")
            return
        self._receive(data.tobytes())

    def close(self) -> None:
        """Gives the camera back."""
        with contextlib.suppress(usb.core.USBError):
            usb.util.dispose_resources(self._device)
