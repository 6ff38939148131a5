"""Finds where states are sent by the address that a person writes."""

from typing import Final, NamedTuple
from urllib.parse import SplitResult, urlsplit

from neurotouch_hid.stream.sender import Sender

HERE: Final = "127.0.0.1"
PORTS: Final = {"osc": 9000, "websocket": 8765}
KNOWN: Final = "osc://HOST:PORT, websocket, websocket://HOST:PORT, lsl or ros2"


class Address(NamedTuple):
    """An address as a person writes it.

    Attributes:
        kind: ``osc``, ``websocket``, ``lsl`` or ``ros2``.
        host: of OSC and WebSocket.
        port: likewise.
    """

    kind: str
    host: str = HERE
    port: int = 0


def read_address(text: str) -> Address:
    """Returns what an address means.

    Raises:
        ValueError: it means nothing; the text says why.
    """
    try:
        parts = urlsplit(text if "://" in text else f"{text}://")
    except ValueError:
        raise ValueError(f"'{text}' is no address to stream to. Use {KNOWN}.") from None
    kind = {"ws": "websocket"}.get(parts.scheme, parts.scheme)
    if kind in ("lsl", "ros2") and not parts.netloc and not parts.path:
        return Address(kind)
    if kind not in PORTS or (parts.path and not parts.netloc):
        raise ValueError(f"'{text}' is no address to stream to. Use {KNOWN}.")
    host, port = _read_place(text, parts)
    if kind == "osc" and port == 0:  # a server may take any that is free
        raise ValueError(_say_port(text))
    if parts.path not in ("", "/") or parts.query or parts.fragment or parts.username is not None:
        raise ValueError(f"'{text}' has more than a host and a port. Use {KNOWN}.")
    return Address(kind, host or HERE, PORTS[kind] if port is None else port)


def open_target(address: Address, *, markers: bool) -> Sender:
    """Opens what an address means.

    Args:
        address: where to send.
        markers: whether the displacement of each marker is sent, too.

    Raises:
        StreamError: its library is missing, or the address cannot be used.
    """
    # Each of them needs a library that the others do not.
    if address.kind == "osc":
        from neurotouch_hid.stream.osc import OscSender  # noqa: PLC0415

        return OscSender(address.host, address.port, markers=markers)
    if address.kind == "websocket":
        from neurotouch_hid.stream.web_socket import WebSocketServer  # noqa: PLC0415

        return WebSocketServer(address.host, address.port, markers=markers)
    if address.kind == "lsl":
        from neurotouch_hid.stream.lsl import LslOutlets  # noqa: PLC0415

        return LslOutlets(markers=markers)
    raise ValueError(f"'{address.kind}' is a program of its own")


def _read_place(text: str, parts: SplitResult) -> tuple[str | None, int | None]:
    try:
        return parts.hostname, parts.port
    except ValueError:
        raise ValueError(_say_port(text)) from None


def _say_port(text: str) -> str:
    return f"'{text}' needs a port from 1 to 65535 after the host."
