"""What every source is."""

from collections.abc import Iterator
from types import TracebackType
from typing import Protocol, Self

from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import EventPacket


class Source(Protocol):
    """Equal slices of sensor time in order, empty ones included; a context manager.

    Attributes:
        name: the source as the user may write it.
        rig: how the sensor sees the gel where that is known beforehand, else None.
    """

    name: str
    rig: Rig | None

    def __iter__(self) -> Iterator[EventPacket]:
        """The packets from the start on."""
        ...

    def close(self) -> None:
        """Release what the source holds."""
        ...

    def __enter__(self) -> Self:
        """The source itself."""
        ...

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close it."""
        ...
