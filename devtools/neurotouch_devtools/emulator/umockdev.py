"""Plugs an emulated camera into programs that this process starts: no root, no kernel module.

umockdev preloads a library into a program and passes that program's system calls on device nodes to
this process; the libusb inside is the real one. This module answers the calls of usbfs
(Linux, ``include/uapi/linux/usbdevice_fs.h``). It needs Debian's ``umockdev``,
``gir1.2-umockdev-1.0`` and ``python3-gi``; programs are started with ``environment``.
"""

import errno
import os
import struct
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any

from neurotouch_devtools.emulator.camera import EmulatedCamera
from neurotouch_devtools.emulator.descriptors import PRODUCT_ID, VENDOR_ID, Identity
from neurotouch_devtools.emulator.port import Port, UnpluggedError
from neurotouch_devtools.emulator.usb import CONFIGURATION, DEVICE, Setup
from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import SourceError

PRELOAD = "libumockdev-preload.so.0"
_PATH = "/sys/devices/pci0000:00/usb1/1-1"
_SYSTEM_PACKAGES = "/usr/lib/python3/dist-packages"

_SUBMIT, _DISCARD, _REAP, _REAP_NO_DELAY = 0x8038550A, 0x550B, 0x4008550C, 0x4008550D
_CAPABILITIES, _GET_DRIVER, _CLEAR_HALT = 0x8004551A, 0x41045508, 0x80045515
_NOTHING_TO_DO = {
    0x80045505,  # SETCONFIGURATION
    0x80085504,  # SETINTERFACE
    0x8004550F,  # CLAIMINTERFACE
    0x80045510,  # RELEASEINTERFACE
    0x8108551B,  # DISCONNECT_CLAIM
    0x80045503,  # RESETEP
    0x5514,  # RESET
}
_URB = struct.Struct("<BBxxiI4xQiiiiiIQ")
_STATUS_AT, _BUFFER_AT, _LENGTH_AT = 4, 16, 28
_URB_CONTROL = 2
_SETUP_SIZE = 8
_CAN_DO = 0x01 | 0x04 | 0x10  # zero packets, no size limit, reaping after the end
_PAUSE_S = 0.0005


class Umockdev(Closing):
    """An emulated camera in the device folder of programs that are started with ``environment``.

    Args:
        camera: the camera.

    Attributes:
        camera: the same, or the one that was plugged in last.
        environment: environment of a program that sees this camera and no other device.

    Raises:
        SourceError: umockdev is not installed.
    """

    def __init__(self, camera: EmulatedCamera) -> None:
        self._library = _load()
        self._testbed = self._library.Testbed.new()
        folder = self._testbed.get_root_dir()
        self.environment = {**os.environ, "UMOCKDEV_DIR": folder, "LD_PRELOAD": PRELOAD}
        self._address = 1
        self._socket: _Socket | None = None
        self.plug(camera)

    def plug(self, camera: EmulatedCamera) -> None:
        """Plugs a camera in if there is none.

        Programs that listen to udev are notified only if umockdev's library is preloaded here, too;
        others see the camera anyway.
        """
        self.camera = camera
        self._address += 1  # as Linux does, another one each time
        self._testbed.add_from_string(_describe(camera.config.identity, self._address))
        self._socket = _Socket(camera, self.unplug)
        self._handler = self._library.IoctlBase.new()
        self._handler.connect("handle-ioctl", self._socket.handle)
        self._testbed.attach_ioctl(_node(self._address), self._handler)
        self._tell("add")

    def unplug(self) -> None:
        """Pulls the cable; waiting calls end."""
        pulled, self._socket = self._socket, None
        if pulled:
            pulled.end()
            self._tell("remove")
            self._testbed.remove_device(_PATH)

    def _tell(self, action: str) -> None:
        if PRELOAD in os.environ.get("LD_PRELOAD", ""):  # or udev's library does not find it
            self._testbed.uevent(_PATH, action)

    def close(self) -> None:
        """Removes the camera and its device folder."""
        self.unplug()
        for address in range(2, self._address + 1):
            self._testbed.detach_ioctl(_node(address))


class _Socket:
    """The device node of a camera: answers the system calls on it.

    Args:
        camera: the camera.
        unplug: called when the camera has unplugged itself.
    """

    def __init__(self, camera: EmulatedCamera, unplug: Callable[[], None]) -> None:
        self._port, self._unplug = Port(camera), unplug
        self._gone = False
        self._lock = threading.RLock()  # the cable is pulled in one thread, calls come in another
        self._urbs: dict[int, tuple[Any, Any]] = {}  # by address in the program: URB, buffer
        self._done: deque[Any] = deque()

    def end(self) -> None:
        """Ends the calls after the cable was pulled."""
        with self._lock:
            self._gone = True
            for address in list(self._urbs):
                self._finish(address, -errno.ESHUTDOWN, b"", 0)

    def handle(self, _: Any, client: Any) -> bool:
        """Answers one call of the program; umockdev calls this in a separate thread."""
        try:
            with self._lock:
                code = self._carry_out(client.get_request(), client.get_arg())
        except UnpluggedError:
            self._unplug()
            code = errno.ENODEV
        client.complete(-1 if code else 0, code)
        return True

    def _carry_out(self, request: int, argument: Any) -> int:
        """Carries out a call; returns its errno."""
        if request in {_REAP, _REAP_NO_DELAY}:
            return self._reap(argument)
        if self._gone:
            return errno.ENODEV
        if request == _CAPABILITIES:
            argument.resolve(0, 4).update(0, struct.pack("<I", _CAN_DO))
        elif request == _SUBMIT:
            self._submit(argument)
        elif request == _DISCARD:
            (address,) = struct.unpack("<Q", bytes(argument.retrieve()))
            cancelled = self._port.cancel(address)
            if cancelled:
                self._finish(address, -errno.ENOENT, b"", 0)
            return errno.EINVAL if cancelled is False else 0
        elif request == _CLEAR_HALT:
            self._port.clear_halt()
        elif request == _GET_DRIVER:
            return errno.ENODATA  # no driver of the kernel holds the interface
        elif request not in _NOTHING_TO_DO:
            return errno.ENOTTY
        return 0

    def _submit(self, argument: Any) -> None:
        urb = argument.resolve(0, _URB.size)
        kind, endpoint, _, _, _, length, *_ = _URB.unpack(bytes(urb.retrieve()))
        buffer: Any = urb.resolve(_BUFFER_AT, length)
        address = urb.client_addr
        self._urbs[address] = (urb, buffer)
        if kind != _URB_CONTROL:
            self._port.submit(address, endpoint, length)
            return
        content = bytes(buffer.retrieve())
        setup = Setup.parse(content[:_SETUP_SIZE])
        done = self._port.control(address, setup, b"" if setup.is_in else content[_SETUP_SIZE:])
        if done:
            answer = content[:_SETUP_SIZE] + done.data if setup.is_in else b""
            self._finish(address, done.status, answer, done.length)

    def _reap(self, argument: Any) -> int:
        """Returns one URB that has ended."""
        if not self._done and not self._gone:
            for done in self._port.completions():
                self._finish(done.number, done.status, done.data, done.length)
        if not self._done:
            # The node always looks ready, so libusb asks again and again.
            time.sleep(_PAUSE_S)
            return errno.ENODEV if self._gone else errno.EAGAIN
        argument.resolve(0, 8).set_ptr(0, self._done.popleft())
        return 0

    def _finish(self, address: int, status: int, data: bytes, length: int) -> None:
        urb, buffer = self._urbs.pop(address)
        urb.update(_STATUS_AT, struct.pack("<i", status))
        urb.update(_LENGTH_AT, struct.pack("<i", length))
        if data:  # a buffer of no length is None
            buffer.update(0, data)
        self._done.append(urb)


def _node(address: int) -> str:
    return f"/dev/bus/usb/001/{address:03d}"


def _describe(identity: Identity, address: int) -> str:
    """Returns a camera in umockdev's format."""
    descriptors = (identity.describe(DEVICE, 0) or b"") + (
        identity.describe(CONFIGURATION, 0) or b""
    )
    attributes = {
        "busnum": 1,
        "devnum": address,
        "bConfigurationValue": 1,
        "speed": 5000 if identity.super_speed else 480,
        "idVendor": f"{VENDOR_ID:04x}",
        "idProduct": f"{PRODUCT_ID:04x}",
        "bcdDevice": f"{identity.version:04x}",
        "product": identity.product,
        "manufacturer": "iniVation",
        "serial": identity.serial,
    }
    lines = [
        f"P: {_PATH.removeprefix('/sys')}",
        f"N: {_node(address).removeprefix('/dev/')}",
        f"E: DEVNAME={_node(address)}",
        "E: DEVTYPE=usb_device",
        "E: SUBSYSTEM=usb",
        "E: BUSNUM=001",
        f"E: DEVNUM={address:03d}",
        *(f"A: {name}={text}\\n" for name, text in attributes.items() if text is not None),
        f"H: descriptors={descriptors.hex().upper()}",
    ]
    return "\n".join(lines) + "\n"


def _load() -> Any:
    """Returns umockdev's library, if needed through the bindings of the system's Python."""
    sys.path.append(_SYSTEM_PACKAGES)
    try:
        import gi  # noqa: PLC0415 - only those who use it have it

        gi.require_version("UMockdev", "1.0")
        from gi.repository import UMockdev  # noqa: PLC0415
    except (ImportError, ValueError) as error:
        raise SourceError(
            "The library umockdev cannot be loaded.",
            hint="Debian: apt install umockdev gir1.2-umockdev-1.0 python3-gi",
        ) from error
    finally:
        sys.path.remove(_SYSTEM_PACKAGES)  # no other package may come from there
    return UMockdev
