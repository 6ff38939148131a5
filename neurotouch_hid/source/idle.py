"""Merges slices that contain only noise, so that an idle pipeline seldom wakes."""

from typing import Final

from neurotouch_hid.events import join_events
from neurotouch_hid.messages import EventPacket

LONGEST_US: Final = 48_000
"""Twelve slices of a camera. The tracker remembers twice that and an exposure, so it can still use
what frames show. More events than the noise makes end the wait at once. A push so slow that it
makes fewer (a twentieth of the usual events) is answered later, by half of this on average."""
MOST_EVENTS: Final = 4_000
"""The tracker takes 0.1 ms for this many; the slice after the joined ones must not be late. Where
noise alone makes this many events, they cost more time than waking the pipeline does."""
MOST_PER_US: Final = 2
"""The same for slices shorter than 2 ms, which leave less time: events a µs of one slice."""
CALM_US: Final = 100_000
"""Time without activity after which slices are merged."""

_LEARN: Final = 1 / 64  # weight of a slice in the estimate of the noise: a quarter of a second
_STANDS_OUT: Final = 5.0  # mean deviations, four standard ones: by chance once in two minutes
_FEW: Final = 8.0  # events; a quiet sensor's deviation may be 0


class IdleMerger:
    """Merges slices while the pipeline is idle and they contain only noise.

    Attributes:
        is_idle: the pipeline has nothing to do; None while unknown. Set from any thread.
    """

    def __init__(self) -> None:
        self.is_idle: bool | None = None
        self._waiting: list[EventPacket] = []
        self._n_waiting = 0
        self._passes = True
        self._calm_us = 0
        self._mean = self._deviation = 0.0
        self._n_heard = 0

    @property
    def takes_partials(self) -> bool:
        """True if the next slice will probably not wait here: the one before did not."""
        return self.is_idle is not None and self._passes

    @property
    def is_calm(self) -> bool:
        """True while the pipeline is idle and recent events were only noise."""
        return self._calm_us > CALM_US

    def take(self, packet: EventPacket) -> tuple[EventPacket, ...]:
        """Returns nothing, or this slice joined with all slices that waited.

        Args:
            packet: the next slice, all of one length.
        """
        if not self.is_idle:
            self._calm_us = 0
            self._passes = True
            return self._release(packet)
        length_us = packet.t_end_us - packet.t_begin_us
        is_calm = self._listen(len(packet.events)) and not packet.gap
        self._calm_us = self._calm_us + length_us if is_calm else 0
        begin_us = self._waiting[0].t_begin_us if self._waiting else packet.t_begin_us
        n_next = self._n_waiting + 2 * len(packet.events)  # with one more like this
        if (
            not self.is_calm
            or packet.t_end_us + length_us - begin_us > LONGEST_US
            or n_next > min(MOST_EVENTS, MOST_PER_US * length_us)
        ):
            self._passes = not self._waiting
            return self._release(packet)
        self._passes = False
        self._wait(packet)
        return ()

    def flush(self) -> tuple[EventPacket, ...]:
        """Returns the waiting slices as one, if any."""
        waiting, self._waiting, self._n_waiting = self._waiting, [], 0
        return (_join(waiting),) if waiting else ()

    def _release(self, packet: EventPacket) -> tuple[EventPacket, ...]:
        if not self._waiting:
            return (packet,)
        if packet.gap or packet.t_begin_us != self._waiting[-1].t_end_us:
            return (*self.flush(), packet)
        self._wait(packet)
        return self.flush()

    def _wait(self, packet: EventPacket) -> None:
        self._waiting.append(packet)
        self._n_waiting += len(packet.events)

    def _listen(self, n_events: int) -> bool:
        """Returns True if this many events are noise; learns the noise while idle."""
        if not self._n_heard:
            self._mean = n_events
        self._n_heard += 1
        share = max(_LEARN, 1.0 / self._n_heard)  # fast at first
        off = n_events - self._mean
        most = _STANDS_OUT * self._deviation + _FEW
        learnt = min(off, most)  # a burst changes it little, a new lamp does over time
        self._mean += share * learnt
        self._deviation += share * (abs(learnt) - self._deviation)
        return off <= most


def _join(packets: list[EventPacket]) -> EventPacket:
    if len(packets) == 1:
        return packets[0]
    events = join_events([packet.events for packet in packets])
    frames = tuple(frame for packet in packets for frame in packet.frames)
    return EventPacket(packets[0].t_begin_us, packets[-1].t_end_us, events, frames, packets[0].gap)
