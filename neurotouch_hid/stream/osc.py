"""Open Sound Control over UDP: one bundle for each state."""

import socket
from typing import TYPE_CHECKING, Any, Final

from neurotouch_hid.errors import StreamError
from neurotouch_hid.stream.reading import Reading
from neurotouch_hid.stream.sender import Sender

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT: Final = "/neurotouch"


class OscSender(Sender):
    """Sends states to a host and port; nobody has to listen there.

    Args:
        host: name or address.
        port: UDP port, 1 to 65535.
        markers: whether the displacement of each marker is sent, too.

    Raises:
        StreamError: python-osc is missing, or the host is not known.
    """

    def __init__(self, host: str, port: int, *, markers: bool) -> None:
        try:
            from pythonosc import osc_bundle_builder, osc_message_builder  # noqa: PLC0415
        except ImportError:
            raise StreamError(
                "OSC needs python-osc, which is not installed.",
                hint="Install it: pip install 'neurotouch-hid[osc]'",
            ) from None
        self._make_bundle = osc_bundle_builder.OscBundleBuilder
        self._make_message = osc_message_builder.OscMessageBuilder
        self._now = osc_bundle_builder.IMMEDIATELY
        self._markers = markers
        try:
            family, kind, _, _, place = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
            self._socket = socket.socket(family, kind)
        except OSError as error:
            raise StreamError(
                f"'{host}' cannot be reached: {error.strerror}.",
                hint="Check the name, or give its address in numbers.",
            ) from error
        self._socket.setblocking(False)
        self._place = place
        self.name = f"osc://{f'[{host}]' if ':' in host else host}:{port}"

    def send(self, reading: Reading) -> None:
        """Sends a state; it is lost if the network has no room for it."""
        bundle = self._make_bundle(self._now)
        for path, values in list_messages(reading, markers=self._markers):
            message = self._make_message(f"{ROOT}/{path}")
            for value in values:
                message.add_arg(value)
            bundle.add_content(message.build())
        try:
            self._socket.sendto(bundle.build().dgram, self._place)
        except OSError:  # nobody listens, no route, no room: the next state may arrive
            return

    def close(self) -> None:
        """Closes the socket."""
        self._socket.close()


def list_messages(reading: Reading, *, markers: bool) -> "Iterator[tuple[str, list[Any]]]":
    """Yields the messages of a state: the address below ``/neurotouch``, and the arguments."""
    yield "state", [reading.state]
    yield "simulated", [int(reading.simulated)]
    yield "time", [reading.t_us / 1e6]
    yield "gesture", [reading.kind, reading.intensity_mm, reading.confidence]
    yield "movement", [reading.movement]
    yield "moved", [*map(float, reading.moved_mm)]
    yield "turned", [float(reading.turned_rad)]
    yield "scale", [float(reading.scale)]
    yield "contacts", [float(each) for point in reading.contacts_mm for each in point]
    for name, value in reading.axes.items():
        yield f"pad/{name}", [float(value)]
    for name, is_down in reading.buttons.items():
        yield f"pad/{name}", [int(is_down)]
    if markers:
        yield "markers", reading.markers_mm.ravel().tolist()
