"""Pictures for the page: the camera's newest frame, and a link as a QR code."""

import base64

from neurotouch_hid.client import open_stream
from neurotouch_hid.errors import PageError
from neurotouch_hid.recording.wire import receive_packets

_PATIENCE_S = 3.0
_QUIET = 2
"""Modules of white around a code; with the two of the encoder they are the four that it needs."""


def take_picture() -> str:
    """Returns the newest frame of the running driver as a data address.

    Raises:
        DriverError: none runs, or it does not answer.
        PageError: no frame arrives.
    """
    _, line = open_stream("record")
    with line:
        line.settimeout(_PATIENCE_S)
        try:
            frame = next(
                (frame for packet in receive_packets(line) for frame in packet.frames), None
            )
        except TimeoutError:
            frame = None
    if frame is None:
        raise PageError("The camera sends no picture.", hint="See below: Check this machine.")
    return _write(frame.pixels)


def draw_code(link: str) -> str:
    """Returns a link as a QR code, as a data address."""
    import cv2  # noqa: PLC0415  # a large import for one picture
    import numpy as np  # noqa: PLC0415

    modules = cv2.QRCodeEncoder.create().encode(link)
    framed = np.pad(modules, _QUIET, constant_values=255)
    return _write(np.kron(framed, np.ones((8, 8), np.uint8)))


def _write(pixels: object) -> str:
    import cv2  # noqa: PLC0415

    _, content = cv2.imencode(".png", pixels)
    return f"data:image/png;base64,{base64.b64encode(content.tobytes()).decode()}"
