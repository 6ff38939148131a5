"""Plugs an emulated camera into the real kernel of this machine, by USB/IP and without a network.

The kernel's ``vhci_hcd`` takes any stream socket as a cable. One end of a socket pair goes to it;
at the other a thread answers the kernel's requests: 48-byte headers, big endian, then data
(Linux, Documentation/usb/usbip_protocol.rst).
"""

import contextlib
import errno
import os
import select
import socket
import struct
import threading
from pathlib import Path

from neurotouch_devtools.emulator.port import Camera, Completion, Port, UnpluggedError
from neurotouch_devtools.emulator.usb import IN, Setup
from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import NeuroTouchError, SourceError

VHCI = Path("/sys/devices/platform/vhci_hcd.0")

_SUBMIT, _UNLINK, _ANSWER_SUBMIT, _ANSWER_UNLINK = 1, 2, 3, 4
_HEADER = struct.Struct(">IIIII")  # command, number, device, direction, endpoint
_SUBMITTED = struct.Struct(">IiiiI8s")  # flags, length, start frame, packets, interval, setup
_SIZE = 48
_FREE = "004"
_HIGH_SPEED, _SUPER_SPEED = 3, 5
_BUS = 1
"""Our number for the camera at the other end; nothing checks it."""


class UsbIp(Closing):
    """A cable from an emulated camera to the kernel; a context manager, closing it unplugs.

    Args:
        camera: the camera.

    Attributes:
        number: the number of the port at the virtual host controller.

    Raises:
        SourceError: the kernel offers no virtual host controller, or this user may not use it.
    """

    def __init__(self, camera: Camera) -> None:
        self._port = Port(camera)
        self._error: NeuroTouchError | None = None
        self._ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_STREAM)
        self._thread = threading.Thread(target=self._serve, name="usbip", daemon=True)
        try:
            with theirs:
                self.number = _attach(theirs, super_speed=camera.super_speed)
        except BaseException:
            self._ours.close()
            raise
        self._thread.start()

    def close(self) -> None:
        """Pulls the cable."""
        with contextlib.suppress(OSError):  # the kernel may have released it before
            self._ours.shutdown(socket.SHUT_RDWR)
        self._thread.join()

    def wait(self, timeout_s: float | None = None) -> bool:
        """Waits until the cable is pulled; False if time runs out first.

        Raises:
            NeuroTouchError: the scene's source has failed; the camera is unplugged.
        """
        self._thread.join(timeout_s)
        if self._error is not None:
            raise self._error
        return not self._thread.is_alive()

    def _serve(self) -> None:
        # The cable is pulled here, or there, or by a fault.
        with self._ours, contextlib.suppress(OSError, UnpluggedError):
            try:
                while True:
                    if select.select([self._ours], [], [], self._port.patience_s)[0]:
                        self._take_command()
                    for done in self._port.completions():
                        self._complete(done)
            except NeuroTouchError as error:
                self._error = error

    def _take_command(self) -> None:
        head = self._receive(_SIZE)
        command, number, _, direction, endpoint = _HEADER.unpack_from(head)
        if command == _UNLINK:
            (target,) = struct.unpack_from(">I", head, _HEADER.size)
            cancelled = self._port.cancel(target)
            if cancelled is not None:
                # 0: the transfer was answered before, the host has it already
                self._send(_ANSWER_UNLINK, number, -errno.ECONNRESET if cancelled else 0)
            return
        _, length, _, _, _, setup = _SUBMITTED.unpack_from(head, _HEADER.size)
        data = self._receive(length) if not direction else b""
        if endpoint:
            self._port.submit(number, endpoint | (IN if direction else 0), length)
        else:
            done = self._port.control(number, Setup.parse(setup), data)
            if done:
                self._complete(done)

    def _complete(self, done: Completion) -> None:
        self._send(_ANSWER_SUBMIT, done.number, done.status, done.length, done.data)

    def _send(
        self, command: int, number: int, status: int, length: int = 0, data: bytes = b""
    ) -> None:
        head = _HEADER.pack(command, number, 0, 0, 0) + struct.pack(">ii", status, length)
        self._ours.sendall(head.ljust(_SIZE, b"\0") + data)

    def _receive(self, n_bytes: int) -> bytes:
        parts = bytearray()
        while len(parts) < n_bytes:
            part = self._ours.recv(n_bytes - len(parts))
            if not part:
                raise ConnectionError
            parts += part
        return bytes(parts)


def find_port(*, super_speed: bool) -> int:
    """Returns the number of a free virtual port of the right speed.

    Raises:
        SourceError: there is none, or this user may not use it.
    """
    try:
        lines = (VHCI / "status").read_text().splitlines()[1:]
    except FileNotFoundError as error:
        raise SourceError(
            "This kernel offers no virtual USB port.", hint="As root: modprobe vhci-hcd"
        ) from error
    if not os.access(VHCI / "attach", os.W_OK):
        raise SourceError(
            "Only root may plug in an emulated camera.",
            hint="Put sudo in front; by its path: sudo .venv/bin/neurotouch emulate",
        )
    hub = "ss" if super_speed else "hs"
    for line in lines:
        its_hub, port, state, *_ = line.split()
        if its_hub == hub and state == _FREE:
            return int(port)
    raise SourceError(
        "All virtual USB ports are taken.", hint="Unplug another emulated camera first."
    )


def _attach(cable: socket.socket, *, super_speed: bool) -> int:
    """Connects the cable to a free port; returns its number."""
    port = find_port(super_speed=super_speed)
    speed = _SUPER_SPEED if super_speed else _HIGH_SPEED
    (VHCI / "attach").write_text(f"{port} {cable.fileno()} {_BUS << 16 | port + 1} {speed}")
    return port
