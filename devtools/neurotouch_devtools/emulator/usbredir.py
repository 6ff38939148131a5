"""Plugs an emulated camera into a virtual machine from outside, by the protocol of usb-redir.

The machine has a whole USB controller of its own, so its kernel suspends and resets the camera like
a real one. QEMU's ``usb-redir`` is at the other end of a UNIX socket: packets of a header of 12
bytes, or 16 once both sides know 64-bit numbers, then data, little endian
(usbredir, docs/usb-redirection-protocol.md).
"""

import contextlib
import errno
import select
import socket
import struct
import threading
from enum import IntEnum
from pathlib import Path
from typing import Final

from neurotouch_devtools.emulator.port import Camera, Completion, Port, UnpluggedError
from neurotouch_devtools.emulator.usb import (
    CONFIGURATION,
    DEVICE,
    ENDPOINT,
    IN,
    INTERFACE,
    Setup,
    Standard,
)
from neurotouch_hid.closing import Closing


class _Kind(IntEnum):
    HELLO = 0
    DEVICE_CONNECT = 1
    RESET = 3
    INTERFACE_INFO = 4
    ENDPOINT_INFO = 5
    SET_CONFIGURATION = 6
    GET_CONFIGURATION = 7
    CONFIGURATION_STATUS = 8
    SET_ALT_SETTING = 9
    GET_ALT_SETTING = 10
    ALT_SETTING_STATUS = 11
    CANCEL = 21
    CONTROL = 100
    BULK = 101


_CAPABILITIES: Final = 1 << 1 | 1 << 4 | 1 << 5 | 1 << 6
"""The device's version, packet sizes, 64-bit numbers, lengths of 32 bits."""
_HELLO: Final = struct.Struct("<64sI")
_CONTROL: Final = struct.Struct("<BBBBHHH")  # endpoint, request, type, status, value, index, length
_BULK: Final = struct.Struct("<BBHIH")  # endpoint, status, length, stream, length's upper half
_N_ENDPOINTS: Final = 32
_NONE: Final = 255
"""The type of an endpoint that does not exist."""
_HIGH_SPEED, _SUPER_SPEED = 2, 3
_STATUS: Final = {0: 0, -errno.EPIPE: 4, -errno.EPROTO: 3, -errno.EOVERFLOW: 6}
_CANCELLED: Final = 1


class UsbRedir(Closing):
    """A cable from an emulated camera to a virtual machine; a context manager, closing it unplugs.

    Args:
        camera: the camera.
        path: the socket of QEMU, which must be there.

    Raises:
        OSError: nobody listens there.
    """

    def __init__(self, camera: Camera, path: Path) -> None:
        self._camera, self._port = camera, Port(camera)
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            self._socket.connect(str(path))
        except BaseException:
            self._socket.close()
            raise
        self._head = struct.Struct("<III")
        self._asked: dict[int, tuple[_Kind, bytes]] = {}  # by number; the header of the answer
        self._configuration = 0
        self._thread = threading.Thread(target=self._serve, name="usb-redir", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Pulls the cable."""
        with contextlib.suppress(OSError):  # the machine may have ended before
            self._socket.shutdown(socket.SHUT_RDWR)
        self._thread.join()

    def _serve(self) -> None:
        # The cable is pulled here, or there, or by a fault.
        with self._socket, contextlib.suppress(OSError, UnpluggedError):
            self._greet()
            while True:
                if select.select([self._socket], [], [], self._port.patience_s)[0]:
                    self._take()
                for done in self._port.completions():
                    self._complete(done)

    def _greet(self) -> None:
        self._send(_Kind.HELLO, 0, _HELLO.pack(b"emulated camera", _CAPABILITIES))
        self._receive()  # every QEMU since 2.0 can do what is needed here
        self._head = struct.Struct("<IIQ")
        device, configuration = self._describe(DEVICE, 18), self._describe(CONFIGURATION, 4096)
        for kind, data in _describe_interfaces(configuration):
            self._send(kind, 0, data)
        speed = _SUPER_SPEED if self._camera.super_speed else _HIGH_SPEED
        self._send(_Kind.DEVICE_CONNECT, 0, bytes([speed]) + device[4:7] + device[8:14])

    def _describe(self, kind: int, length: int) -> bytes:
        setup = Setup(IN, Standard.GET_DESCRIPTOR, kind << 8, 0, length)
        done = self._port.control(0, setup, b"")
        if done is None or done.status:
            raise ConnectionError("the camera does not describe itself")
        return done.data

    def _take(self) -> None:
        kind, number, data = self._receive()
        match kind:
            case _Kind.CONTROL:
                self._control(number, data)
            case _Kind.BULK:
                endpoint, _, low, _, high = _BULK.unpack_from(data)
                self._asked[number] = _Kind.BULK, data[: _BULK.size]
                self._port.submit(number, endpoint, high << 16 | low)
            case _Kind.SET_CONFIGURATION | _Kind.GET_CONFIGURATION:
                if kind == _Kind.SET_CONFIGURATION:
                    self._configuration = data[0]
                    self._request(Standard.SET_CONFIGURATION, data[0], 0)
                self._send(_Kind.CONFIGURATION_STATUS, number, bytes([0, self._configuration]))
            case _Kind.SET_ALT_SETTING | _Kind.GET_ALT_SETTING:
                if kind == _Kind.SET_ALT_SETTING:
                    self._request(Standard.SET_INTERFACE, data[1], data[0])
                self._send(_Kind.ALT_SETTING_STATUS, number, bytes([0, data[0], 0]))
            case _Kind.CANCEL:
                if self._port.cancel(number):
                    self._answer(number, _CANCELLED, 0, b"")
            case _Kind.RESET:
                self._reset()

    def _request(self, request: Standard, value: int, index: int) -> None:
        self._port.control(0, Setup(0, request, value, index, 0), b"")

    def _control(self, number: int, data: bytes) -> None:
        _, request, request_type, _, value, index, length = _CONTROL.unpack_from(data)
        self._asked[number] = _Kind.CONTROL, data[: _CONTROL.size]
        setup = Setup(request_type, request, value, index, length)
        done = self._port.control(number, setup, data[_CONTROL.size :])
        if done:
            self._complete(done)

    def _reset(self) -> None:
        """Forgets what was asked: nobody waits for it any more, and the stream begins again."""
        self._port = Port(self._camera)
        self._asked.clear()
        self._configuration = 0

    def _complete(self, done: Completion) -> None:
        self._answer(done.number, _STATUS[done.status], done.length, done.data)

    def _answer(self, number: int, status: int, length: int, data: bytes) -> None:
        kind, head = self._asked.pop(number)
        if kind is _Kind.CONTROL:
            endpoint, request, request_type, _, value, index, _ = _CONTROL.unpack(head)
            head = _CONTROL.pack(endpoint, request, request_type, status, value, index, length)
        else:
            endpoint, _, _, stream, _ = _BULK.unpack(head)
            head = _BULK.pack(endpoint, status, length & 0xFFFF, stream, length >> 16)
        self._send(kind, number, head + data)

    def _send(self, kind: _Kind, number: int, data: bytes) -> None:
        self._socket.sendall(self._head.pack(kind, len(data), number) + data)

    def _receive(self) -> tuple[int, int, bytes]:
        kind, length, number = self._head.unpack(self._read(self._head.size))
        return kind, number, self._read(length)

    def _read(self, n_bytes: int) -> bytes:
        data = self._socket.recv(n_bytes, socket.MSG_WAITALL)
        if len(data) < n_bytes:
            raise ConnectionError
        return data


def _describe_interfaces(configuration: bytes) -> list[tuple[_Kind, bytes]]:
    """Returns what the machine must know of the endpoints and interfaces of a configuration."""
    types, intervals, owners = bytearray([_NONE] * _N_ENDPOINTS), bytearray(32), bytearray(32)
    types[0] = types[0x10] = 0  # control
    sizes = [64] * _N_ENDPOINTS
    interfaces: list[bytes] = []
    at = 0
    while at < len(configuration):
        length, kind = configuration[at : at + 2]
        part = configuration[at : at + length]
        if kind == INTERFACE and part[3] == 0:  # of the first setting
            interfaces.append(bytes([part[2], *part[5:8]]))
        elif kind == ENDPOINT:
            place = (part[2] & IN) >> 3 | part[2] & 0x0F
            types[place], intervals[place] = part[3] & 0b11, part[6]
            owners[place] = interfaces[-1][0]
            (sizes[place],) = struct.unpack_from("<H", part, 4)
        at += length
    columns = (bytes(each).ljust(32, b"\0") for each in zip(*interfaces, strict=True))
    return [
        (_Kind.INTERFACE_INFO, struct.pack("<I", len(interfaces)) + b"".join(columns)),
        (_Kind.ENDPOINT_INFO, bytes(types + intervals + owners) + struct.pack("<32H", *sizes)),
    ]
