"""Interface of ``neuromorphic-drivers``, as far as it is used, and the way to load it."""

from collections.abc import Iterator, Sequence
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import CameraError

INSTALL: Final = "pip install 'neurotouch-hid[events]'"
"""The command that installs the extra."""


class ListedDevice(Protocol):
    """A camera that is plugged in.

    Attributes:
        name: its model, an enumeration whose ``value`` a person can read.
        connection: how it is plugged in, likewise.
        address: where: bus and number at the USB, or its address in a network.
        serial: its serial number; None if it could not be read.
        error: why it could not be read, or None.
    """

    name: Any
    connection: Any
    address: str
    serial: str | None
    error: str | None


class Picture(Protocol):
    """A frame of a camera that has frames; times in µs, None where it does not know them."""

    exposure_start_t: int | None
    exposure_end_t: int | None
    t: int
    pixels: NDArray[np.uint16]


class Ring(Protocol):
    """State of the library's buffers when a packet was taken.

    Attributes:
        system_time: when its first part arrived, s since 1970.
        backlog: buffers that still wait.
        current_t: the camera's time, µs; no later event is older.
        dropped_packets: parts that were lost on their way.
    """

    system_time: float
    backlog: int
    current_t: int
    dropped_packets: int


class Status(Protocol):
    """State when a packet was taken.

    Attributes:
        system_time: the present, s since 1970.
        ring: None if nothing came in time.
    """

    system_time: float
    ring: Ring | None


class Device(Protocol):
    """An open camera: an iterator over status and packet."""

    def __next__(self) -> tuple[Status, Any]:
        """Returns status and packet, the latter None if nothing came in time.

        A packet has ``polarity_events``, records of ``t``, ``x``, ``y`` and ``on``, or None,
        ``polarity_events_overflow_indices`` or None, and that of a DAVIS ``frames``.

        Raises:
            RuntimeError: the camera is gone, or has failed.
        """
        ...

    def __iter__(self) -> Iterator[tuple[Status, Any]]:
        """Returns itself."""
        ...

    def close(self) -> None:
        """Stops and releases the camera."""
        ...

    def clear_backlog(self, until: int) -> None:
        """Throws buffers away until fewer than ``until`` wait."""
        ...

    def serial(self) -> str:
        """Returns its serial number."""
        ...


class Library(Protocol):
    """The library itself; each model has a module of its own, with its ``Configuration``.

    Attributes:
        RowColumnMask: makes the words of a mask of rows and columns.
    """

    RowColumnMask: Any

    def list_devices(self) -> Sequence[ListedDevice]:
        """Returns the cameras that are plugged in. Each free one is opened for a moment.

        Raises:
            RuntimeError: the USB cannot be asked.
        """
        ...

    def open(
        self,
        *,
        configuration: Any,
        iterator_timeout: float,
        serial: str | None,
        ring_configuration: Any,
    ) -> Device:
        """Opens a camera, configures and starts it.

        Raises:
            RuntimeError: it cannot.
        """
        ...


def load_library() -> Library:
    """Returns the library.

    Raises:
        CameraError: the extra is not installed; says how to.
    """
    try:
        import neuromorphic_drivers  # noqa: PLC0415
    except ImportError as error:
        raise CameraError(
            "The sources 'events:' need the package neuromorphic-drivers, which is missing.",
            hint=f"Install it: {INSTALL}",
        ) from error
    library: Library = neuromorphic_drivers
    return library
