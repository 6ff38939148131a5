"""Interfaces that sources implement."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Protocol, Self, runtime_checkable

from neurotouch_hid.driver_state import SourceFacts
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.recording.sensor import Sensor
from neurotouch_hid.source.view import View

if TYPE_CHECKING:
    from neurotouch_hid.recording.clip import Picture


class Source(Protocol):
    """Equal slices of sensor time in order, empty ones included; a context manager.

    Attributes:
        name: the source as the user may write it.
        rig: how the sensor sees the gel, if known beforehand, else None.
        is_live: the packets come in real time and cannot be repeated, as from a camera.
        is_simulated: the packets come from a simulation, not from a sensor.
    """

    name: str
    rig: Rig | None
    is_live: bool
    is_simulated: bool

    def __iter__(self) -> Iterator[EventPacket]:
        """Yields the packets from the start."""
        ...

    def close(self) -> None:
        """Closes everything that the source opened."""
        ...

    def __enter__(self) -> Self:
        """Returns the source itself."""
        ...

    def __exit__(self, *_: object) -> None:
        """Closes it."""
        ...


@runtime_checkable
class ActivityAware(Protocol):
    """A source that merges or splits slices to suit the pipeline."""

    def set_activity(self, *, is_idle: bool, wants_frames: bool = True) -> None:
        """Tells the source whether the pipeline is idle; without a call, slices come one by one.

        While the pipeline is idle, slices with only noise may come as one, with fewer frames if
        it does not want them. Otherwise a partial slice (``EventPacket.is_partial``) may come
        shortly before the end of the slice.
        """
        ...


@runtime_checkable
class FactTelling(Protocol):
    """A source that knows facts about itself that viewers are shown."""

    def tell_facts(self) -> SourceFacts:
        """Returns the facts; from any thread."""
        ...


@runtime_checkable
class Troubled(Protocol):
    """A source that may be unable to give packets for a while."""

    @property
    def trouble(self) -> str:
        """The reason why no packets come, in a sentence; empty while they come."""
        ...

    @property
    def n_restarts(self) -> int:
        """Times it was started again because its data made no sense."""
        ...


@runtime_checkable
class Periodic(Protocol):
    """A source whose packets come only with a picture, such as a video camera."""

    @property
    def period_s(self) -> float:
        """Time from picture to picture as it was lately; 0 before the first."""
        ...

    @property
    def n_lost(self) -> int:
        """Pictures that were lost, or could not be read."""
        ...


@runtime_checkable
class PictureSource(Source, Protocol):
    """A source whose sensor gives pictures alone, of a size of its own."""

    @property
    def view(self) -> View | None:
        """The map from the sensor's pictures to the frames now; None before the first picture."""
        ...

    def pictures(self) -> "Iterator[Picture]":
        """Yields the sensor's pictures as they are, instead of packets."""
        ...


@runtime_checkable
class SizedSource(Source, Protocol):
    """A source whose sensor gives events, in a picture of a size of its own."""

    @property
    def sensor(self) -> Sensor | None:
        """The sensor; None before it was opened."""
        ...

    def sensor_packets(self) -> Iterator[EventPacket]:
        """Yields slices in the sensor's own pixels instead of canonical ones."""
        ...


@runtime_checkable
class PolledSource(Source, Protocol):
    """A source that may have no packets for a while, such as a camera that was unplugged."""

    def poll(self) -> Iterator[EventPacket | None]:
        """Yields the packets as they arrive, and None at least whenever none did for 1/20 s."""
        ...
