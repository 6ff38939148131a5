"""Ends a driver that no longer finds its camera: Linux shows it, and libusb does not."""

import time
from collections.abc import Callable
from typing import Final, Protocol, runtime_checkable

from neurotouch_hid.errors import CameraError
from neurotouch_hid.source import Source

PATIENCE_S: Final = 10.0
"""Twenty attempts of the source, each in a libusb context of its own."""


@runtime_checkable
class Seeing(Protocol):
    """A source that looks for a camera again and again."""

    @property
    def is_blind(self) -> bool:
        """Linux showed a camera at the last attempt, and opening it found nothing there."""


class CameraWatchdog:
    """Watches whether the source finds the camera that sysfs shows.

    A camera that is unplugged, refused, in use elsewhere or mute is no reason: only one that
    stays there and cannot be found means that something in this process is broken, which a new
    process does not inherit.

    Args:
        source: the source to watch; any but a camera never goes blind.
        clock_s: host time.
    """

    def __init__(self, source: Source, clock_s: Callable[[], float] = time.monotonic) -> None:
        self._source = source if isinstance(source, Seeing) else None
        self._clock_s = clock_s
        self._well_s = clock_s()

    def check(self) -> None:
        """Checks the camera; call it in every pass of the loop.

        Raises:
            CameraError: the source has been blind for ``PATIENCE_S``.
        """
        if self._source is None:
            return
        now_s = self._clock_s()
        if not self._source.is_blind:
            self._well_s = now_s
        elif now_s - self._well_s > PATIENCE_S:
            raise CameraError(
                "Linux shows a camera, but this process cannot find it.",
                hint="Restart the driver; the service restarts by itself.",
            )
