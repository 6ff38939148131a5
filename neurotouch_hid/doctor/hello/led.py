"""Measures latency and bandwidth by an LED before the lens, which the computer switches."""

import math
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.messages import EventPacket

N_FLASHES: Final = 20
_DARK_S: Final = 0.4
_LONGER_S: Final = 0.2
"""The dark lasts up to this much longer, so that flashes come at all moments of a frame."""
_GOLDEN: Final = 0.618_034
_SETTLING_S: Final = 0.2
"""Of the dark: events of switching off are over then."""
_PATIENCE_S: Final = 1.0
_TIMES: Final = 4.0
_LEAST_EVENTS_S: Final = 200_000.0
"""ON events/s beyond those of the dark, in which nothing moves."""
_BRIGHTER_DN: Final = 5.0
"""Of the mean of a frame."""
_LIT_S: Final = 0.05
"""The LED stays on this long once it is seen, so that also slow pixels follow."""
_LEAST_RISE: Final = 1_000.0
"""ON events of a flash from which its rise is measured."""
_BIN_US: Final = 20
_EARLY: Final = 0.1
_HALF: Final = 0.5
_UNSEEN: Final = 3
_MOST_BYTES: Final = 16


class LedMeter(Closing):
    """Switches an LED, and notes when slices show that it is on; in the end it is as it was.

    Args:
        path: a file that takes a number, 0 for off, such as ``brightness`` of an LED that is listed
            in ``/sys/class/leds``.
        clock_s: host time.

    Attributes:
        delays_s: of each flash that was seen, the time until a slice that shows it was finished.

    Raises:
        NeuroTouchError: the LED cannot be switched.
    """

    def __init__(self, path: Path, clock_s: Callable[[], float] = time.monotonic) -> None:
        self.delays_s: list[float] = []
        self._rises_us: list[float] = []
        """Of each flash that events show, the time from the first tenth of them to half."""
        self._path, self._clock_s = path, clock_s
        self._before = _read(path)
        self._bright = _read_brightest(path)
        self._is_on = False
        self._switched_s = 0.0
        self._usual_events_s = 0.0
        self._usual_dn: float | None = None
        self._delay_s = 0.0
        self._lit: list[NDArray[np.int64]] = []
        """Times of the ON events since it is seen."""
        self._n_unseen = 0
        self._switch(on=False)

    def close(self) -> None:
        """Leaves it as it was."""
        self._write(self._before)

    @property
    def is_done(self) -> bool:
        """True once enough flashes were seen."""
        return len(self.delays_s) >= N_FLASHES

    def restart(self) -> None:
        """Forgets the flashes that were seen."""
        self.delays_s.clear()
        self._rises_us.clear()
        self._lit.clear()
        self._n_unseen = 0
        self._switch(on=False)

    def take(self, packet: EventPacket) -> str:
        """Looks at a slice that is finished now; returns what the person should hear, or nothing.

        Raises:
            NeuroTouchError: the LED cannot be switched any more.
        """
        if self.is_done:
            return ""
        since_s = self._clock_s() - self._switched_s
        seconds = 1e-6 * (packet.t_end_us - packet.t_begin_us)
        events_s = np.count_nonzero(packet.events["p"]) / seconds
        level_dn = float(packet.frames[-1].pixels.mean()) if packet.frames else None
        if not self._is_on:
            self._wait(since_s, events_s, level_dn)
            return ""
        if self._lit or self._shows(events_s, level_dn):
            return self._watch(packet, since_s)
        if since_s < _PATIENCE_S:
            return ""
        self._n_unseen += 1
        self._switch(on=False)
        return (
            "" if self._n_unseen % _UNSEEN else "The LED is not seen. Hold it nearer to the lens."
        )

    def _watch(self, packet: EventPacket, since_s: float) -> str:
        """Collects the events of a flash that is seen, until the LED may go off."""
        if not self._lit:
            self._delay_s = since_s
        self._lit.append(packet.events["t"][packet.events["p"] > 0])
        if since_s < self._delay_s + _LIT_S:
            return ""
        rise_us = _measure_rise(np.concatenate(self._lit), 1e-6 * self._usual_events_s)
        if rise_us is not None:
            self._rises_us.append(rise_us)
        self.delays_s.append(self._delay_s)
        self._n_unseen = 0
        self._lit.clear()
        self._switch(on=False)
        return "That is enough. Go on when you like." if self.is_done else ""

    def list_figures(self) -> dict[str, float | None]:
        """Returns the figures; None for what was not seen.

        ``bandwidth_hz`` is the least that the photoreceptors can have: of a first-order low pass
        that rises as the events did, although the LED and the readout take time as well.
        """
        delays_ms = [1e3 * each for each in self.delays_s]
        return {
            "led_flashes": float(len(delays_ms)),
            "led_latency_ms": median(delays_ms) if delays_ms else None,
            "led_latency_most_ms": max(delays_ms, default=None),
            "bandwidth_hz": _find_bandwidth(median(self._rises_us)) if self._rises_us else None,
        }

    def _wait(self, since_s: float, events_s: float, level_dn: float | None) -> None:
        if since_s < _SETTLING_S:
            self._usual_events_s, self._usual_dn = 0.0, None
            return
        self._usual_events_s = max(self._usual_events_s, events_s)
        if level_dn is not None:
            self._usual_dn = max(self._usual_dn or 0.0, level_dn)
        if since_s >= _DARK_S + _LONGER_S * (_GOLDEN * len(self.delays_s) % 1.0):
            self._switch(on=True)

    def _shows(self, events_s: float, level_dn: float | None) -> bool:
        if events_s > _TIMES * self._usual_events_s + _LEAST_EVENTS_S:
            return True
        if level_dn is None or self._usual_dn is None:
            return False
        return level_dn > self._usual_dn + _BRIGHTER_DN

    def _switch(self, *, on: bool) -> None:
        self._switched_s, self._is_on = self._clock_s(), on
        self._write(self._bright if on else 0)

    def _write(self, brightness: int) -> None:
        try:
            with self._path.open("wb", buffering=0) as file:
                file.write(b"%d\n" % brightness)
        except OSError as error:
            raise _refuse(self._path, error.strerror or "it fails") from error


def _measure_rise(times_us: NDArray[np.int64], usual_per_us: float) -> float | None:
    """Returns the time from the first tenth of a flash's events to half; None if it shows none.

    Args:
        times_us: (n,) int64, when pixels became brighter.
        usual_per_us: as many come without a flash.
    """
    if not len(times_us):
        return None
    counts = np.bincount((times_us - times_us.min()) // _BIN_US)
    sums = np.cumsum(counts - usual_per_us * _BIN_US)
    most = sums.max()
    if most < _LEAST_RISE:
        return None
    early, half = (int(np.argmax(sums >= share * most)) for share in (_EARLY, _HALF))
    return float(_BIN_US * max(half - early, 1))


def _find_bandwidth(rise_us: float) -> float:
    """Returns the corner of a first-order low pass, in Hz, whose step rises in this time."""
    constant_us = rise_us / math.log((1.0 - _EARLY) / (1.0 - _HALF))
    return 1e6 / (2.0 * math.pi * constant_us)


def _read(path: Path) -> int:
    """Returns the brightness now. A file without a number is no LED, and stays as it is."""
    try:
        with path.open("rb") as file:
            return int(file.read(_MOST_BYTES))
    except OSError as error:
        raise _refuse(path, error.strerror or "it fails") from error
    except ValueError as error:
        raise _refuse(path, "it has no number") from error


def _refuse(path: Path, why: str) -> NeuroTouchError:
    return NeuroTouchError(
        f"'{path}' switches no LED: {why}.",
        hint="Give the file 'brightness' of an LED in /sys/class/leds that you may write.",
    )


def _read_brightest(path: Path) -> int:
    """Returns the number for full brightness, which Linux lists beside that of an LED."""
    try:
        return int(path.with_name("max_brightness").read_text())
    except (OSError, ValueError):
        return 1
