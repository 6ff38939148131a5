"""Interface of a USB connection to a camera: requests, a stream, and an end."""

from collections.abc import Callable
from typing import Protocol

from neurotouch_hid.errors import CameraError

TIMEOUT_MS = 1_000
"""How long the camera may take to answer a request."""

LOOK_US = 5_000
"""How often a transport looks at what has come while it rests for long. The first motion is seen
half of this later on average. At 12 million events/s it fills a third of the transfers."""

ANY_TIME = -1
"""No time of the camera is needed: any data will do."""

Receive = Callable[[bytes], object]
"""Takes the bytes of one transfer, in the transport's thread; empty bytes: here some are lost."""


class StreamHaltedError(CameraError):
    """The stream's endpoint has stalled; ``queue`` restarts it."""


class Transport(Protocol):
    """An open camera with its interface claimed. One thread at a time may use it."""

    def request(self, code: int, value: int, index: int, data: bytes | int) -> bytes:
        """Makes one vendor request: ``data`` to write, or how many bytes to read.

        Raises:
            CameraGoneError: the camera is gone.
            CameraError: it refused, or took too long.
        """
        ...

    def queue(self, receive: Receive) -> None:
        """Clears the stream's endpoint and asks for data, ahead of all that comes.

        Raises:
            CameraError: this cannot be done.
        """
        ...

    def pump(self, timeout_s: float, rest_until_s: float, time_word: int, most_noise: int) -> None:
        """Delivers the data that has arrived; if there is none, waits about ``timeout_s`` for it.

        Args:
            timeout_s: how long to wait.
            rest_until_s: no data is needed before this time of ``time.monotonic``; a transport that
                loses nothing meanwhile may sleep, and then wait for later data.
            time_word: a time of the camera up to which data is needed then, 15 bits; or ANY_TIME.
                A transport may wait a little for it.
            most_noise: if not 0, the rest ends as soon as more events come in ``LOOK_US``:
                something happens.

        Raises:
            CameraGoneError: the camera is gone.
            StreamHaltedError: the endpoint has stalled.
        """
        ...

    def close(self) -> None:
        """Cancels all transfers and releases the camera. A second call does nothing."""
        ...
