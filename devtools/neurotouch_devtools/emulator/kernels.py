"""The compiled loop that turns events and a frame's readout into the camera's 16-bit words."""

from numba import njit

# Where the encoder's state is kept: an int64 array.
BASE = 0
"""µs: what the wrap words add up to."""
LOW = 1
"""The low 15 bits of the last time sent; 0 right after a wrap or a reset."""
ROW = 2
"""The row word that holds, -1 for none."""
ROW_LOW = 3
"""The low 15 bits of the time that dates the row word."""
STATE_SIZE = 4

TIME_FLAG = 0x8000
TIME_MASK = 0x7FFF
ROW_CODE = 0x1000
OFF_CODE = 0x2000
ON_CODE = 0x3000
WRAP_CODE = 0x7000
MAX_WRAPS = 0xFFF


@njit(cache=True, nogil=True)
def _put_time(t_us, state, out, n):  # type: ignore[no-untyped-def]
    """Put what the host lacks of the time into ``out`` behind ``n`` words; return their number.

    What was held back is dated with the time that the host knows already: time never goes back.
    """
    t_us = max(t_us, state[BASE] + state[LOW])
    wraps = (t_us - state[BASE]) >> 15
    while wraps > 0:
        m = min(wraps, MAX_WRAPS)
        out[n] = WRAP_CODE | m
        n += 1
        state[BASE] += m << 15
        state[LOW] = 0
        state[ROW] = -1
        wraps -= m
    low = (t_us - state[BASE]) & TIME_MASK
    if low != state[LOW]:
        out[n] = TIME_FLAG | low
        n += 1
        state[LOW] = low
    return n


@njit(cache=True, nogil=True)
def encode(  # type: ignore[no-untyped-def]
    t, rows, columns, on, first, item_t, item_end, item_dated, readout, item, until_us, state, out
):
    """Merge events and readout items before ``until_us`` into words.

    Args:
        t: (n,) int64 µs, camera time of the events, ascending.
        rows: (n,) int16, the address of the row word.
        columns: (n,) int16, the address of the event word.
        on: (n,) bool.
        first: index of the first event that has not been sent.
        item_t: (k,) int64 µs, when each run of words of the readout is due, ascending.
        item_end: (k,) int64, index after the run's last word in ``readout``.
        item_dated: (k,) bool: the run begins with a time word if the time has changed.
        readout: uint16, the words of the readout.
        item: index of the first run that has not been sent.
        until_us: camera time; events and runs at this time or later wait.
        state: (STATE_SIZE,) int64, kept from call to call.
        out: uint16, long enough: 4 words an event, 2 and its length a run, and some wraps.

    Returns:
        The number of words, the next event, the next run.
    """
    n = 0
    while True:
        event_due = first < len(t) and t[first] < until_us
        item_due = item < len(item_t) and item_t[item] < until_us
        if not event_due and not item_due:
            return n, first, item
        if item_due and (not event_due or item_t[item] <= t[first]):
            if item_dated[item]:
                n = _put_time(item_t[item], state, out, n)
            for k in range(item_end[item - 1] if item else 0, item_end[item]):
                out[n] = readout[k]
                n += 1
            item += 1
            continue
        n = _put_time(t[first], state, out, n)
        if rows[first] != state[ROW] or state[LOW] != state[ROW_LOW]:
            out[n] = ROW_CODE | rows[first]
            n += 1
            state[ROW] = rows[first]
            state[ROW_LOW] = state[LOW]
        out[n] = (ON_CODE if on[first] else OFF_CODE) | columns[first]
        n += 1
        first += 1


@njit(cache=True, nogil=True)
def catch_up(t_us, state, out):  # type: ignore[no-untyped-def]
    """Put the wrap words of a camera in which nothing happens; return their number."""
    wrapped_us = t_us & ~TIME_MASK
    if wrapped_us <= state[BASE]:
        return 0
    return _put_time(wrapped_us, state, out, 0)
