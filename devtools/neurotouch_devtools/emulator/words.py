"""Encodes events and frames as the 16-bit words that the camera's logic sends."""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from neurotouch_devtools.emulator.faults import FaultKind
from neurotouch_devtools.emulator.kernels.encode import (
    STATE_DTYPE,
    AddressEvents,
    Runs,
    catch_up,
    encode_words,
)
from neurotouch_devtools.emulator.readout import NO_READOUT, Readout, Special, Words
from neurotouch_hid.messages import EVENT_DTYPE

_NO_EVENTS = np.empty(0, EVENT_DTYPE)
_NO_WORDS = np.empty(0, np.uint16)
_GARBLED = {
    # Of an earlier run: much later, events of a row, the rest of a frame.
    FaultKind.STALE: (0x7123, 0x9234, 0x1020, 0x3030, 0x2031, 0x4300, 0x000D, 0x000A),
    FaultKind.RANGE: (0x1190, 0x3005, 0x100A, 0x312C),  # row 400, then column 300 of row 10
    FaultKind.UNKNOWN: (0x0000, 0x0006, 0x0020, 0x5F00, 0x6C00),
}


class WordEncoder:
    """Makes the words, and keeps the state that the host knows: time and row.

    Args:
        swap: the chip is turned by 90 degrees: row words carry x, event words y.
    """

    def __init__(self, *, swap: bool) -> None:
        self._swap = swap
        self._state = np.zeros(1, STATE_DTYPE)
        self._out = np.empty(1 << 16, np.uint16)
        self._state["row"] = -1
        # Compile or load the kernels now: a camera that is plugged in must answer without a pause.
        self.encode(_NO_EVENTS, deque(), until_us=0, shift_us=0)
        self.wrap(0)

    def reset(self) -> Words:
        """Starts the time again at 0, and tells the host."""
        self._state[:] = 0
        self._state["row"] = -1
        return np.array([Special.TIMESTAMP_RESET], np.uint16)

    def encode(
        self, events: NDArray[np.void], readouts: deque[Readout], *, until_us: int, shift_us: int
    ) -> Words:
        """Returns the words due before a moment: events and frames, merged in order of time.

        Args:
            events: (n,) EVENT_DTYPE, all before ``until_us``.
            readouts: the frames on their way, one after the other; those that are done are removed.
            until_us: scene time.
            shift_us: camera time minus scene time.
        """
        t_us = events["t"] + shift_us
        rows, columns = ("x", "y") if self._swap else ("y", "x")
        # copies: for each memory layout the kernel would be compiled again, in mid-stream
        row, column, on = (events[name].copy() for name in (rows, columns, "p"))
        addressed = AddressEvents(t_us, row, column, on)
        parts, first = [], 0
        while True:
            readout = readouts[0] if readouts else NO_READOUT
            stop_us = min(until_us, int(readout.t_us[-1]) + 1) if readouts else until_us
            n, first, readout.next = encode_words(
                addressed,
                first,
                Runs(readout.t_us + shift_us, readout.end, readout.dated, readout.words),
                readout.next,
                stop_us + shift_us,
                self._state,
                self._make_room(4 * (len(events) - first) + readout.n_words_left),
            )
            parts.append(self._out[:n].copy())
            if not readout.done or not readouts:
                break
            readouts.popleft()
        return parts[0] if len(parts) == 1 else np.concatenate(parts)

    def encode_dated(self, words: list[int], t_us: int) -> Words:
        """Returns words of a camera time: a time word goes first if the host lacks it."""
        if not words:
            return _NO_WORDS
        run = Readout(
            np.array([t_us]), np.array([len(words)]), np.array([True]), np.array(words, np.uint16)
        )
        return self.encode(_NO_EVENTS, deque([run]), until_us=t_us + 1, shift_us=0)

    def wrap(self, t_us: int) -> Words:
        """Returns the wrap words that are due at a camera time if nothing happens before it."""
        n = catch_up(t_us, self._state, self._out)
        return self._out[:n].copy()

    def garble(self, kind: FaultKind) -> Words:
        """Returns words that a healthy camera does not send; later words are correct again."""
        low = int(self._state["low"][0])
        self._state["row"] = -1
        return np.array([*_GARBLED.get(kind, ()), *_backward(kind, low)], np.uint16)

    def _make_room(self, n_words: int) -> Words:
        if len(self._out) < n_words:
            self._out = np.empty(2 * n_words, np.uint16)
        return self._out


def _backward(kind: FaultKind, low: int) -> tuple[int, ...]:
    if kind is not FaultKind.BACKWARD or low < 2:
        return ()
    return 0x8000 | low // 2, 0x8000 | low
