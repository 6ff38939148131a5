"""Speaks to a Wayland compositor: the wire format of messages, and the list of globals."""

import select
import socket
import struct
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Final, NamedTuple

from neurotouch_hid.errors import DesktopError

PATIENCE_S: Final = 1.0
_HEADER: Final = struct.Struct("=IHH")  # object, opcode, length with this header
_WORD: Final = struct.Struct("=I")

DISPLAY: Final = 1  # the object that every connection begins with
_SYNC, _GET_REGISTRY = 0, 1
_ERROR: Final = 0
_BIND: Final = 0
_GLOBAL: Final = 0


class Message(NamedTuple):
    """An event of the compositor.

    Attributes:
        sender: number of the object it is from.
        opcode: number of the event in the object's interface.
        body: the arguments.
    """

    sender: int
    opcode: int
    body: bytes

    def take_word(self, at: int = 0) -> int:
        """Returns the 32 bits at this byte: a number, or an object.

        Raises:
            DesktopError: the message is shorter.
        """
        if at + 4 > len(self.body):
            raise DesktopError("A message of the Wayland compositor is too short.")
        return int(_WORD.unpack_from(self.body, at)[0])

    def take_array(self, at: int = 0) -> bytes:
        """Returns the array at this byte. A text is an array too, with a zero at its end.

        Raises:
            DesktopError: the message is shorter.
        """
        size = self.take_word(at)
        if at + 4 + size > len(self.body):
            raise DesktopError("A message of the Wayland compositor is too short.")
        return self.body[at + 4 : at + 4 + size]

    def take_text(self, at: int = 0) -> str:
        """Returns the text at this byte.

        Raises:
            DesktopError: the message is shorter.
        """
        return self.take_array(at).rstrip(b"\0").decode("utf-8", "replace")


class Wayland:
    """A connection to a compositor.

    Args:
        path: its socket.

    Attributes:
        peer: the socket.

    Raises:
        DesktopError: the compositor cannot be reached.
    """

    def __init__(self, path: str) -> None:
        self._next = DISPLAY + 1
        self._received = b""
        self.peer = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM | socket.SOCK_CLOEXEC)
        self.peer.settimeout(PATIENCE_S)
        try:
            self.peer.connect(path)
        except OSError as error:
            self.peer.close()
            raise DesktopError(
                f"The Wayland compositor cannot be reached: {error.strerror or error}."
            ) from None

    def new(self) -> int:
        """Returns the number of a new object of ours."""
        self._next += 1
        return self._next - 1

    def send(self, receiver: int, opcode: int, *arguments: int | str) -> None:
        """Sends a request: numbers, objects and texts.

        Raises:
            DesktopError: the compositor is gone.
        """
        try:
            self.peer.sendall(pack(receiver, opcode, *arguments))
        except OSError as error:
            raise _gone(error) from None

    def take(self, timeout_s: float = 0.0) -> Iterator[Message]:
        """Yields the events that have arrived; waits for the first.

        Raises:
            DesktopError: the compositor is gone, or it has found an error in our requests.
        """
        if select.select([self.peer], [], [], timeout_s)[0]:
            try:
                piece = self.peer.recv(65536)
            except OSError as error:
                raise _gone(error) from None
            if not piece:
                raise _gone(None)
            self._received += piece
        while len(self._received) >= _HEADER.size:
            sender, opcode, length = _HEADER.unpack_from(self._received)
            if length < _HEADER.size:
                raise DesktopError("A message of the Wayland compositor cannot be read.")
            if len(self._received) < length:
                return
            message = Message(sender, opcode, self._received[_HEADER.size : length])
            self._received = self._received[length:]
            if (sender, opcode) == (DISPLAY, _ERROR):
                raise DesktopError(f"The Wayland compositor refuses: {message.take_text(8)}.")
            yield message

    def round_trip(self, hear: Callable[[Message], object]) -> None:
        """Passes on events until the compositor has answered all requests so far.

        Raises:
            DesktopError: the compositor is gone or does not answer.
        """
        callback = self.new()
        self.send(DISPLAY, _SYNC, callback)
        is_done = False
        while not is_done:
            messages = list(self.take(PATIENCE_S))
            if not messages:
                raise DesktopError("The Wayland compositor does not answer.")
            for message in messages:
                if message.sender == callback:
                    is_done = True
                else:
                    hear(message)

    def list_globals(self) -> tuple[int, dict[str, tuple[int, int]]]:
        """Returns the registry, and name and version of each global by its interface.

        Raises:
            DesktopError: the compositor is gone or does not answer.
        """
        registry = self.new()
        found: dict[str, tuple[int, int]] = {}

        def hear(message: Message) -> None:
            if (message.sender, message.opcode) == (registry, _GLOBAL):
                size = len(message.take_array(4))
                version = message.take_word(8 + size + -size % 4)
                found[message.take_text(4)] = message.take_word(), version

        self.send(DISPLAY, _GET_REGISTRY, registry)
        self.round_trip(hear)
        return registry, found

    def bind(self, registry: int, interface: str, name: int, version: int) -> int:
        """Returns a new object for a global.

        Raises:
            DesktopError: the compositor is gone.
        """
        number = self.new()
        self.send(registry, _BIND, name, interface, version, number)
        return number

    def close(self) -> None:
        """Ends the connection."""
        self.peer.close()


def pack(receiver: int, opcode: int, *arguments: int | str) -> bytes:
    """Returns a message in the wire format."""
    body = b""
    for argument in arguments:
        if isinstance(argument, int):
            body += _WORD.pack(argument & 0xFFFFFFFF)
        else:
            text = argument.encode() + b"\0"
            body += _WORD.pack(len(text)) + text + bytes(-len(text) % 4)
    return _HEADER.pack(receiver, opcode, _HEADER.size + len(body)) + body


def find_display(environment: Mapping[str, str]) -> str:
    """Returns the path of the compositor's socket that the environment names."""
    display = environment.get("WAYLAND_DISPLAY", "")
    return str(Path(environment.get("XDG_RUNTIME_DIR", "/")) / display)


def _gone(error: OSError | None) -> DesktopError:
    reason = (error.strerror or str(error)) if error else "it has closed the connection"
    return DesktopError(f"The Wayland compositor is gone: {reason}.")
