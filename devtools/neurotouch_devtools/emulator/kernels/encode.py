"""The compiled loop that turns events and a frame's readout into the camera's 16-bit words."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel

STATE_DTYPE = np.dtype([("base_us", "<i8"), ("low", "<i8"), ("row", "<i8"), ("row_low", "<i8")])
"""State that the host knows: ``base_us`` that the wrap words add up to; ``low`` 15 bits of the
last time sent, 0 right after a wrap or a reset; the ``row`` word that is in force, -1 for none; the
``row_low`` 15 bits of the time that dates it."""


class AddressEvents(NamedTuple):
    """Events as the chip addresses them.

    Attributes:
        t_us: (n,) int64, camera time, ascending.
        row: (n,) int16, the address of the row word.
        column: (n,) int16, the address of the event word.
        on: (n,) bool.
    """

    t_us: NDArray[np.int64]
    row: NDArray[np.int16]
    column: NDArray[np.int16]
    on: NDArray[np.bool_]


class Runs(NamedTuple):
    """The readout of a frame, in runs of words that are due together.

    Attributes:
        t_us: (k,) int64, camera time at which each is due, ascending.
        end: (k,) int64, index after its last word in ``words``.
        dated: (k,) bool: it begins with a time word if the time has changed.
        words: uint16.
    """

    t_us: NDArray[np.int64]
    end: NDArray[np.int64]
    dated: NDArray[np.bool_]
    words: NDArray[np.uint16]


TIME_FLAG = 0x8000
TIME_MASK = 0x7FFF
ROW_CODE = 0x1000
OFF_CODE = 0x2000
ON_CODE = 0x3000
WRAP_CODE = 0x7000
MAX_WRAPS = 0xFFF


@kernel
def _put_time(t_us, state, out, n):  # type: ignore[no-untyped-def]
    """Appends the time words that the host needs to ``n`` words in ``out``; returns their number.

    Delayed words get the time that the host already knows: time never goes back.
    """
    t_us = max(t_us, state["base_us"] + state["low"])
    wraps = (t_us - state["base_us"]) >> 15
    while wraps > 0:
        m = min(wraps, MAX_WRAPS)
        out[n] = WRAP_CODE | m
        n += 1
        state["base_us"] += m << 15
        state["low"] = 0
        state["row"] = -1
        wraps -= m
    low = (t_us - state["base_us"]) & TIME_MASK
    if low != state["low"]:
        out[n] = TIME_FLAG | low
        n += 1
        state["low"] = low
    return n


@kernel
def encode_words(events, first, runs, run, until_us, carried, out):  # type: ignore[no-untyped-def]
    """Merges events and runs of a readout before ``until_us`` into words.

    Args:
        events: AddressEvents.
        first: index of the first event that has not been sent.
        runs: Runs.
        run: index of the first run that has not been sent.
        until_us: camera time; events and runs at this time or later wait.
        carried: (1,) STATE_DTYPE, kept from call to call.
        out: uint16, long enough: 4 words an event, 2 and its length a run, and some wraps.

    Returns:
        The number of words, the next event, the next run.
    """
    state = carried[0]
    n = 0
    while True:
        event_due = first < len(events.t_us) and events.t_us[first] < until_us
        run_due = run < len(runs.t_us) and runs.t_us[run] < until_us
        if not event_due and not run_due:
            return n, first, run
        if run_due and (not event_due or runs.t_us[run] <= events.t_us[first]):
            if runs.dated[run]:
                n = _put_time(runs.t_us[run], state, out, n)
            for k in range(runs.end[run - 1] if run else 0, runs.end[run]):
                out[n] = runs.words[k]
                n += 1
            run += 1
            continue
        n = _put_time(events.t_us[first], state, out, n)
        if events.row[first] != state["row"] or state["low"] != state["row_low"]:
            out[n] = ROW_CODE | events.row[first]
            n += 1
            state["row"] = events.row[first]
            state["row_low"] = state["low"]
        out[n] = (ON_CODE if events.on[first] else OFF_CODE) | events.column[first]
        n += 1
        first += 1


@kernel
def catch_up(t_us, carried, out):  # type: ignore[no-untyped-def]
    """Puts the wrap words of a camera in which nothing happens; returns their number."""
    state = carried[0]
    wrapped_us = t_us & ~TIME_MASK
    if wrapped_us <= state["base_us"]:
        return 0
    return _put_time(wrapped_us, state, out, 0)
