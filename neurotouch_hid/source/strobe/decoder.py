"""Makes frames of the events of a camera whose LED ring goes off at regular times.

Without light each pixel falls towards the same darkness, a bright one farther and sooner. So each
dip shows the gel as a frame does, also where nothing moves. Nothing later knows of it.
"""

import logging
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.events import join_events
from neurotouch_hid.messages import (
    EVENT_DTYPE,
    SENSOR_HEIGHT_PX,
    SENSOR_WIDTH_PX,
    EventPacket,
    Frame,
)
from neurotouch_hid.source.kernels import strobe as kernels
from neurotouch_hid.source.strobe.config import StrobeConfig

_ANSWER_US: Final = 2_000  # after the light came back, in which a bright pixel follows
_BLIND_US: Final = 8_000  # after the light went off; later, dark pixels make less than noise
_EARLY_US: Final = 500  # a dip may come so much before it is due
_BIN_US: Final = 500
_LEAST_OFF: Final = 200  # more OFF than ON events in a bin: all the gel gets darker
_ONE_SIDED: Final = 4  # times as many; motion makes as many of both
_DRIFT: Final = 0.03  # of the period, by which the two clocks may differ
_TRACK: Final = 0.2  # weight of the newest period
_FIRST_SHARE: Final = 0.02  # of the OFF events, with which a dip has begun
_MOST_MISSED: Final = 3  # dips that were due, then it is searched for again
_DARK_DN: Final = 16.0
_BRIGHT_DN: Final = 200.0  # more than dark, where dots are
_DOTS: Final = 0.03  # share of the picture that dots fill
_WARN_US: Final = 2_000_000  # without a dip

log = logging.getLogger(__name__)


class Strobe:
    """Turns each dip of the light into a frame, and takes its events out.

    Args:
        config: how the ring is switched.

    Attributes:
        n_frames: frames so far.
        n_missed: dips that were due and did not show.
    """

    def __init__(self, config: StrobeConfig) -> None:
        self._dark_us = config.dark_us
        self._usual_us = self._period_us = 1e6 / config.hz
        self._due_us: float | None = None  # the next dip; None while it is searched for
        self._blind_until_us = -1
        self._kept: list[NDArray[np.void]] = []  # events of the dip that is under way
        self._onset_us: int | None = None  # the last dip that the search has seen
        self._dark_until_us = -1
        self._n_missed = 0
        self._searched_us = 0
        self._level = np.empty((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), np.float32)
        self.n_frames = self.n_missed = 0

    def take(self, packet: EventPacket) -> EventPacket:
        """Returns a slice without the events of dips, with the frames that they made.

        Args:
            packet: the next slice.
        """
        if packet.gap:
            self._search_again()
        if self._due_us is None:
            self._search(packet)
        if self._due_us is None:
            return packet
        frames, parts = list(packet.frames), []
        events, begin_us = packet.events, packet.t_begin_us
        while begin_us < packet.t_end_us and self._due_us is not None:
            dark_from_us = int(self._due_us) - _EARLY_US
            if self._blind_until_us > begin_us:  # what dark pixels still answer
                end_us = min(self._blind_until_us, packet.t_end_us, dark_from_us)
            elif begin_us < dark_from_us:
                end_us = min(dark_from_us, packet.t_end_us)
                parts.append(_cut(events, begin_us, end_us))
            else:
                over_us = dark_from_us + 2 * _EARLY_US + self._dark_us + _ANSWER_US
                end_us = min(over_us, packet.t_end_us)
                self._kept.append(_cut(events, begin_us, end_us).copy())
                if end_us == over_us:
                    frame = self._end_dip()
                    frames += [] if frame is None else [frame]
            begin_us = max(end_us, begin_us)
        parts.append(_cut(events, begin_us, packet.t_end_us))
        return replace(packet, events=join_events(parts), frames=tuple(frames))

    def _end_dip(self) -> Frame | None:
        """Returns the frame of a dip that is over, and foresees the next one."""
        due_us, events = self._due_us, join_events(self._kept)
        self._kept = []
        if due_us is None:
            return None
        off_us = events["t"][~events["p"]]
        off_us = off_us[off_us < due_us + _EARLY_US + self._dark_us]
        n_on = np.count_nonzero(events["p"] & (events["t"] < due_us + self._dark_us))
        if len(off_us) < _LEAST_OFF + n_on:
            self._miss(due_us)
            return None
        self._n_missed = 0
        begun_us = int(off_us[int(_FIRST_SHARE * len(off_us))])
        period_us = self._period_us + _TRACK * (begun_us - due_us)
        most_us = _DRIFT * self._usual_us
        self._period_us = min(max(period_us, self._usual_us - most_us), self._usual_us + most_us)
        self._due_us = begun_us + self._period_us
        self._blind_until_us = begun_us + _BLIND_US
        self.n_frames += 1
        return self._draw(events, begun_us)

    def _draw(self, events: NDArray[np.void], begun_us: int) -> Frame:
        level, on_us = self._level, begun_us + self._dark_us
        level[:] = 0.0
        kernels.add_answers(events, begun_us, on_us, _ANSWER_US, level)
        smooth = np.zeros_like(level)
        rows = level[:-2] + 2.0 * level[1:-1] + level[2:]
        smooth[1:-1, 1:-1] = rows[:, :-2] + 2.0 * rows[:, 1:-1] + rows[:, 2:]
        n = int((1.0 - _DOTS) * smooth.size)
        most = max(float(np.partition(smooth, n, axis=None)[n]), 1.0)
        pixels = np.minimum(_DARK_DN + _BRIGHT_DN / most * smooth, 255.0).astype(np.uint8)
        pixels.setflags(write=False)
        return Frame(pixels, begun_us, on_us + _ANSWER_US)

    def _miss(self, due_us: float) -> None:
        self.n_missed += 1
        self._n_missed += 1
        self._due_us = due_us + self._period_us
        if self._n_missed == _MOST_MISSED:
            self._search_again()

    def _search_again(self) -> None:
        self._due_us = self._onset_us = None
        self._kept, self._n_missed, self._searched_us = [], 0, 0
        self._period_us = self._usual_us

    def _search(self, packet: EventPacket) -> None:
        """Foresees the next dip once two have come a period apart."""
        events, begin_us = packet.events, packet.t_begin_us
        n_bins = -(-(packet.t_end_us - begin_us) // _BIN_US)
        bins = (events["t"] - begin_us) // _BIN_US
        n_on = np.bincount(bins[events["p"]], minlength=n_bins)
        n_off = np.bincount(bins[~events["p"]], minlength=n_bins)
        for k in np.flatnonzero((n_off >= _ONE_SIDED * n_on) & (n_off >= _LEAST_OFF)):
            off_us = events["t"][(bins == k) & ~events["p"]]
            t_us = int(off_us[int(_FIRST_SHARE * len(off_us))])
            before_us, is_same = self._onset_us, t_us < self._dark_until_us
            self._dark_until_us = t_us + _BLIND_US
            if is_same:
                continue
            self._onset_us = t_us
            period_us = -1 if before_us is None else t_us - before_us
            if abs(period_us - self._usual_us) <= _DRIFT * self._usual_us:
                self._period_us = period_us
                self._due_us = t_us + self._period_us
                self._blind_until_us = t_us + _BLIND_US  # this dip is too far gone for a frame
                return
        before = self._searched_us
        self._searched_us += packet.t_end_us - begin_us
        if before < _WARN_US <= self._searched_us:
            log.warning(
                "camera.yaml says that the LED ring goes off %.3g times a second, but the camera "
                "does not see it. The frequency may be another, or the ring stays on.",
                1e6 / self._usual_us,
            )


def _cut(events: NDArray[np.void], begin_us: int, end_us: int) -> NDArray[np.void]:
    if begin_us >= end_us:
        return _NOTHING
    first, last = np.searchsorted(events["t"], [begin_us, end_us])
    return events[first:last]


_NOTHING: Final = np.empty(0, EVENT_DTYPE)
