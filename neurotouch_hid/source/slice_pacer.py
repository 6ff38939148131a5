"""Makes slices follow the activity: short while the gel moves, joined while nothing happens."""

import math
from collections import deque
from typing import Final, NamedTuple

from neurotouch_hid.events import join_events
from neurotouch_hid.messages import EventPacket

MOVING_US: Final = 1_000
"""Slices while the gel moves. An event waits half of this on average, until its slice ends."""
LONGEST_US: Final = 48_000
"""Twelve slices of a camera. The tracker remembers twice that and an exposure, so it can still use
what frames show. More events than the noise makes end the wait at once. A push so slow that it
makes fewer (a twentieth of the usual events) is answered later, by half of this on average."""
MOST_EVENTS: Final = 4_000
"""The tracker takes 0.1 ms for this many; the slice after the joined ones must not be late. Where
noise alone makes this many events, they cost more time than waking the pipeline does."""
MOST_PER_US: Final = 2
"""The same for slices shorter than 2 ms, which leave less time: events a µs of one slice."""
DENSE_PER_US: Final = 2
"""More events a µs of one slice than this come in parts, even if nothing moves: the pipeline works
on a part while the next one comes, instead of on the whole slice at its end. They are never calm:
they hide the first motion."""
CALM_US: Final = 100_000
"""Time without activity after which slices are joined."""
MOVED_US: Final = 150_000
"""Time without activity after which slices are no longer short. Longer, because a slow finger does
not exceed the noise all the time."""
DOUBT_US: Final = 500_000
"""A slice is learned as noise this time after it, if the pipeline has been idle since. A motion
begins a tenth of a second and more before the pipeline finds a gesture in it. Learned as noise, it
would hide all slower motions after it."""

_LEARN: Final = 1 / 64  # weight of a slice in the estimate of the noise: a quarter of a second
_STANDS_OUT: Final = 5.0  # mean deviations, four standard ones: by chance once in two minutes
_FEW: Final = 8.0  # events; a quiet sensor's deviation may be 0
_CHANCE: Final = 0.8  # mean deviation of independent events, in square roots of their mean


class Calm(NamedTuple):
    """Expectation while nothing happens.

    Attributes:
        until_us: up to this time slices are joined, unless something happens.
        n_events: more of them in a slice of the usual length are not noise.
    """

    until_us: int
    n_events: float


class SlicePacer:
    """Joins slices: up to the usual length, or further while the pipeline is idle.

    The noise is learned while the pipeline is idle and stays so. From then on, a slice of the usual
    length with more events than that shows that the gel moves. While it moves, parts of slices pass
    at once; so do those of slices with very many events.

    Args:
        usual_us: length of the usual slices, which end at multiples of it; parts of them may come
            instead. Without it, each slice counts as one of the usual length.

    Attributes:
        is_idle: the pipeline has nothing to do; None while unknown. Set from any thread.
    """

    def __init__(self, usual_us: int | None = None) -> None:
        self.is_idle: bool | None = None
        self._usual_us = usual_us
        self._waiting: list[EventPacket] = []
        self._n_waiting = 0
        self._passes = True
        self._n_events = self._length_us = 0  # of the usual slice so far
        self._calm_us, self._still_us = 0, MOVED_US + 1
        self._is_dense = False
        self._mean, self._deviation = math.inf, 0.0  # so all is noise at first
        self._most = math.inf  # by how many events noise exceeds its mean
        self._n_heard = 0
        self._doubtful: deque[tuple[int, int]] = deque()  # events and end of slices not yet learned

    @property
    def takes_partials(self) -> bool:
        """True if the next slice will probably not wait here: the one before did not."""
        return self.is_idle is not None and self._passes

    @property
    def is_calm(self) -> bool:
        """True while the pipeline is idle, and recent events were only noise and not very many."""
        return self._calm_us > CALM_US

    def find_calm(self) -> Calm | None:
        """Returns what is expected while it is calm, else None."""
        if not self.is_calm:
            return None
        begin_us = self._waiting[0].t_begin_us if self._waiting else self._doubtful[-1][1]
        return Calm(begin_us + LONGEST_US, self._mean + self._most)

    @property
    def wants_parts(self) -> bool:
        """True while more events come than the noise makes, and a little longer; or very many."""
        return self._still_us <= MOVED_US or self._is_dense

    def take(self, packet: EventPacket) -> tuple[EventPacket, ...]:
        """Returns nothing, or this slice joined with all slices that waited.

        Args:
            packet: the next slice, or the next part of one.
        """
        self._n_events += len(packet.events)
        self._length_us += packet.t_end_us - packet.t_begin_us
        if self._usual_us is not None and packet.t_end_us % self._usual_us:
            if self.wants_parts or packet.gap:
                return self._release(packet)
            self._wait(packet)
            return ()
        n_events, length_us = self._n_events, self._length_us
        self._n_events = self._length_us = 0
        is_noise = self._is_noise(n_events)
        self._still_us = self._still_us + length_us if is_noise else 0
        self._is_dense = n_events > DENSE_PER_US * length_us
        if not self.is_idle:
            self._doubtful.clear()
            self._calm_us = 0
            self._passes = True
            return self._release(packet)
        self._doubtful.append((n_events, packet.t_end_us))
        while self._doubtful[0][1] <= packet.t_end_us - DOUBT_US:
            self._learn(self._doubtful.popleft()[0])
        if not self._n_heard:
            self._mean = min(self._mean, n_events)
            self._most = self._find_most()
        is_calm = is_noise and self._n_heard > 0 and not packet.gap and not self._is_dense
        self._calm_us = self._calm_us + length_us if is_calm else 0
        begin_us = self._waiting[0].t_begin_us if self._waiting else packet.t_begin_us
        n_next = self._n_waiting + len(packet.events) + n_events  # with one more like this
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

    def _is_noise(self, n_events: int) -> bool:
        """Returns True if this many events are noise; until it is known, the quietest slice is."""
        return n_events - self._mean <= self._most

    def _find_most(self) -> float:
        """Returns by how many events noise exceeds its mean, at most."""
        return _STANDS_OUT * max(self._deviation, _CHANCE * math.sqrt(self._mean)) + _FEW

    def _learn(self, n_events: int) -> None:
        if not self._n_heard:
            self._mean = n_events
        self._n_heard += 1
        share = max(_LEARN, 1.0 / self._n_heard)  # fast at first
        # A burst changes it little, a new lamp does over time.
        learnt = min(n_events - self._mean, self._most)
        self._mean += share * learnt
        self._deviation += share * (abs(learnt) - self._deviation)
        self._most = self._find_most()


def _join(packets: list[EventPacket]) -> EventPacket:
    if len(packets) == 1:
        return packets[0]
    events = join_events([packet.events for packet in packets])
    frames = tuple(frame for packet in packets for frame in packet.frames)
    return EventPacket(packets[0].t_begin_us, packets[-1].t_end_us, events, frames, packets[0].gap)
