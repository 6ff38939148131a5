"""Compiled loop that turns the camera's words into events and frames.

A word is 16 bits, little-endian [libcaer ``davis_common.h``]: ``1ttt…`` is the low 15 bits of the
time in µs; else three bits of code and twelve of data. The state between two words is in a record,
so the stream may be cut anywhere.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.source.davis.kernels.samples import count_alike, draw, keep_reset

Records = NDArray[np.void]

# Codes, bits 14-12.
SPECIAL, ROW, COLUMN_OFF, COLUMN_ON, SAMPLE, BYTE, SLICE, WRAP = range(8)

# Data of SPECIAL.
RESET, IMU_BEGIN, IMU_END = 1, 5, 7
INPUT_FIRST, INPUT_LAST = 2, 4  # edges and pulses of the external input
GENERATOR_FIRST, GENERATOR_LAST = 16, 17
FRAME_GLOBAL, FRAME_ROLLING, FRAME_END = 8, 9, 10
COLUMN_RESET, COLUMN_SIGNAL, COLUMN_END = 11, 12, 13
EXPOSURE_BEGIN, EXPOSURE_END = 14, 15

# Bits 11-8 of BYTE.
IMU_BYTE, ROI_HIGH, ROI_LOW, IMU_SETUP = range(4)

WRAP_US = 0x8000


class AddressLayout(NamedTuple):
    """Mapping of a camera's addresses to the picture, as the camera reports it.

    Attributes:
        columns: of the DVS, as the chip counts: limits X words.
        rows: of the DVS, as the chip counts: limits row words.
        swap_events: a row word is an x.
        swap_frames: columns of a frame are rows of the picture.
        flip_columns: a frame's columns come last to first.
        flip_rows: the samples of a column come last to first.
        mirrored: mirror the whole picture, left to right.
        width_px, height_px: size of the picture.
        sample_shift: samples are shifted left by so many bits.
    """

    columns: int = SENSOR_HEIGHT_PX
    rows: int = SENSOR_WIDTH_PX
    swap_events: bool = True
    swap_frames: bool = True
    flip_columns: bool = False
    flip_rows: bool = False
    mirrored: bool = False
    width_px: int = SENSOR_WIDTH_PX
    height_px: int = SENSOR_HEIGHT_PX
    sample_shift: int = 0


STATE_DTYPE = np.dtype(
    [
        ("is_synced", "?"),
        ("is_cut", "?"),
        ("origin_us", "<i8"),
        ("base_us", "<i8"),
        ("now_us", "<i8"),
        ("y", "<i8"),
        ("in_frame", "?"),
        ("is_frame_ok", "?"),
        ("n_limits", "<i8"),
        ("limit_byte", "<i8"),
        ("first_x", "<i8"),
        ("first_y", "<i8"),
        ("last_x", "<i8"),
        ("last_y", "<i8"),
        ("kind", "<i8"),
        ("n_reset_columns", "<i8"),
        ("n_signal_columns", "<i8"),
        ("n_samples", "<i8"),
        ("frame_begin_us", "<i8"),
        ("exposure_begin_us", "<i8"),
        ("exposure_end_us", "<i8"),
    ],
    align=True,
)
"""The state between two words. ``is_synced``: the timestamp reset of the start has been seen.
``is_cut``: bytes are missing before the next word. Of the stream's time: ``origin_us`` at the
camera's time 0, ``base_us`` that the wraps have added up to, ``now_us`` at the last word, which
never goes back. ``y``: the last row word, -1 if none or a wrong one. Of the frame that is being
read: ``first_x``, ``first_y``, ``last_x`` and ``last_y`` are the limits of its region, ``n_limits``
of which have been seen in this order, ``limit_byte`` the high byte of the next; ``kind`` of the
present column; ``n_reset_columns`` and ``n_signal_columns`` read so far; ``n_samples`` in this
column."""

BETWEEN_COLUMNS, RESET_COLUMN, SIGNAL_COLUMN = -1, 0, 1
"""Kinds of a column: its values before the exposure, and after it."""

COUNTERS_DTYPE = np.dtype(
    [
        (name, "<i8")
        for name in (
            "bad_rows",
            "bad_columns",
            "orphans",
            "backward",
            "unknown",
            "resets",
            "bad_frames",
        )
    ]
)
"""Counts of malformed data; see ``DecoderStats``."""


@kernel
def decode(
    layout: AddressLayout,
    carried: Records,
    counted: Records,
    reset: NDArray[np.int16],
    pixels: NDArray[np.uint8],
    words: NDArray[np.uint16],
    start: int,
    events: Records,
    n: int,
) -> tuple[int, int, bool]:
    """Reads words up to the end, or up to the end of a frame.

    Args:
        layout: of the camera.
        carried: (1,) STATE_DTYPE, carried from call to call.
        counted: (1,) COUNTERS_DTYPE, counted up.
        reset: (height, width) int16, the reset values of the frame that is being read.
        pixels: (height, width) uint8, that frame.
        words: (w,) uint16.
        start: the first word to read.
        events: EVENT_DTYPE, long enough for all words.
        n: number of events already in it.

    Returns:
        The first word not read, the number of events, and whether a frame is complete.
    """
    state, counters = carried[0], counted[0]
    if state["is_cut"]:
        _add_missing_wrap(words, start, state)
    columns, rows = layout.columns, layout.rows
    swap, mirrored, last_x = layout.swap_events, layout.mirrored, layout.width_px - 1
    now, y = state["now_us"], state["y"]
    origin = state["origin_us"] + state["base_us"]
    i = start
    if not state["is_synced"]:  # words before the reset are from an earlier run
        while i < len(words) and words[i] != RESET:
            i += 1
        if i == len(words):
            return i, n, False
        state["is_synced"] = True
        i += 1
    while i < len(words):
        word = words[i]
        i += 1
        code, data = word >> 12, np.int64(word & 0xFFF)
        if code & 8:
            t = origin + np.int64(word & 0x7FFF)
            if t <= now:
                counters["backward"] += 1
            else:
                now = t
        elif code in (COLUMN_OFF, COLUMN_ON):
            if data >= columns:
                counters["bad_columns"] += 1
            elif y < 0:
                counters["orphans"] += 1
            else:
                event = events[n]
                event.t = now
                x_px, y_px = (y, data) if swap else (data, y)
                event.x = last_x - x_px if mirrored else x_px
                event.y = y_px
                event.p = code == COLUMN_ON
                n += 1
        elif code == ROW:
            y = data
            if data >= rows:
                counters["bad_rows"] += 1
                y = -1
        elif code == SAMPLE:
            if state["in_frame"]:
                i = _take_samples(words, i - 1, layout, state, reset, pixels)
        elif code == WRAP:
            state["base_us"] += data * WRAP_US
            origin = state["origin_us"] + state["base_us"]
            if origin <= now:
                counters["backward"] += 1
            now = max(now, origin)
        elif code == SPECIAL and data == RESET:
            # The stream's time goes on from where the camera started again.
            counters["resets"] += 1
            counters["bad_frames"] += state["in_frame"]
            state["in_frame"] = False
            state["origin_us"], state["base_us"] = now, 0
            origin, y = now, -1
        elif code == SPECIAL:
            state["now_us"] = now
            if _take_special(data, layout, state, counters):
                state["y"] = y
                return i, n, True
        elif code == BYTE:
            kind = data >> 8
            if kind == ROI_HIGH:
                state["limit_byte"] = data & 0xFF
            elif kind == ROI_LOW:
                _take_limit(data & 0xFF, layout, state, pixels)
            elif kind not in (IMU_BYTE, IMU_SETUP):
                counters["unknown"] += 1
        elif data >> 10:  # SLICE: parts of the exposure in clock cycles, only 0 is in use
            counters["unknown"] += 1
    state["now_us"], state["y"] = now, y
    return i, n, False


@kernel
def _add_missing_wrap(words: NDArray[np.uint16], start: int, state: Records) -> None:
    """Adds the wrap that was in the missing bytes if the first time after them is not later.

    Without it, time would stand still for up to 33 ms.
    """
    for i in range(start, len(words)):
        word = words[i]
        if word & 0x8000:
            t = state["origin_us"] + state["base_us"] + np.int64(word & 0x7FFF)
            if t <= state["now_us"]:
                state["base_us"] += WRAP_US
        elif word >> 12 != WRAP and word != RESET:
            continue
        state["is_cut"] = False
        return


@kernel
def _take_special(data: int, layout: AddressLayout, state: Records, counters: Records) -> bool:
    """Takes a special word other than a timestamp reset; True if it completes a frame."""
    if data in (FRAME_GLOBAL, FRAME_ROLLING):
        counters["bad_frames"] += state["in_frame"]
        now = state["now_us"]
        state["in_frame"] = state["is_frame_ok"] = True
        state["n_limits"], state["kind"] = 0, BETWEEN_COLUMNS
        state["n_reset_columns"] = state["n_signal_columns"] = 0
        state["frame_begin_us"], state["exposure_begin_us"], state["exposure_end_us"] = now, -1, -1
    elif data in (COLUMN_RESET, COLUMN_SIGNAL):
        is_behind = state["n_signal_columns"] >= state["n_reset_columns"]
        is_early = data == COLUMN_SIGNAL and is_behind
        if (
            state["kind"] != BETWEEN_COLUMNS or is_early
        ):  # the one before has no end, or no reset value is known
            state["is_frame_ok"] = False
        state["kind"] = RESET_COLUMN if data == COLUMN_RESET else SIGNAL_COLUMN
        state["n_samples"] = 0
    elif data == COLUMN_END:
        is_between = state["kind"] == BETWEEN_COLUMNS
        if is_between or state["n_samples"] != _expected(layout, state, rows=True):
            state["is_frame_ok"] = False
        if state["kind"] == RESET_COLUMN:
            state["n_reset_columns"] += 1
        elif state["kind"] == SIGNAL_COLUMN:
            state["n_signal_columns"] += 1
        state["kind"] = BETWEEN_COLUMNS
    elif data == EXPOSURE_BEGIN:
        state["exposure_begin_us"] = state["now_us"]
    elif data == EXPOSURE_END:
        state["exposure_end_us"] = state["now_us"]
    elif data == FRAME_END:
        whole: bool = _end_frame(layout, state, counters)
        return whole
    elif not (
        INPUT_FIRST <= data <= INPUT_LAST
        or data in (IMU_BEGIN, IMU_END)
        or GENERATOR_FIRST <= data <= GENERATOR_LAST
    ):
        counters["unknown"] += 1
    return False


@kernel
def _end_frame(layout: AddressLayout, state: Records, counters: Records) -> bool:
    if not state["in_frame"]:
        return False
    state["in_frame"] = False
    n_columns = _expected(layout, state, rows=False)
    is_whole = (
        state["is_frame_ok"]
        and state["n_limits"] == 4
        and state["kind"] == BETWEEN_COLUMNS
        and state["n_reset_columns"] == n_columns
        and state["n_signal_columns"] == n_columns
    )
    if not is_whole:
        counters["bad_frames"] += 1
        return False
    if state["exposure_end_us"] < 0:
        state["exposure_end_us"] = state["now_us"]
    if not 0 <= state["exposure_begin_us"] <= state["exposure_end_us"]:
        state["exposure_begin_us"] = state["frame_begin_us"]
    return True


@kernel
def _expected(layout: AddressLayout, state: Records, rows: bool) -> int:
    """Returns the rows, or columns, of the frame's region as the chip counts them."""
    if rows == layout.swap_frames:
        width: int = state["last_x"] - state["first_x"] + 1
        return width
    height: int = state["last_y"] - state["first_y"] + 1
    return height


@kernel
def _take_limit(low: int, layout: AddressLayout, state: Records, pixels: NDArray[np.uint8]) -> None:
    """Takes the low byte of a limit of the frame's region; the fourth one completes it."""
    if not state["in_frame"] or state["n_limits"] > 3:
        return
    limit, n_before = state["limit_byte"] << 8 | low, state["n_limits"]
    state["n_limits"] += 1
    if n_before == 0:
        state["first_x"] = limit
    elif n_before == 1:
        state["first_y"] = limit
    elif n_before == 2:
        state["last_x"] = limit
    else:
        state["last_y"] = limit
    if state["n_limits"] < 4:
        return
    if not (
        state["first_x"] <= state["last_x"] < layout.width_px
        and state["first_y"] <= state["last_y"] < layout.height_px
    ):
        state["is_frame_ok"] = False
    elif (
        state["last_x"] - state["first_x"] + 1 < layout.width_px
        or state["last_y"] - state["first_y"] + 1 < layout.height_px
    ):
        pixels[:] = 0


@kernel
def _take_samples(
    words: NDArray[np.uint16],
    i: int,
    layout: AddressLayout,
    state: Records,
    reset: NDArray[np.int16],
    pixels: NDArray[np.uint8],
) -> int:
    """Puts readings of the ADC to their pixels; returns the index of the next other word.

    Surplus readings are dropped, and the frame counts as bad.
    """
    kind, row = state["kind"], state["n_samples"]
    n_columns = _expected(layout, state, rows=False)
    n_rows = _expected(layout, state, rows=True)
    column = state["n_signal_columns"] if kind == SIGNAL_COLUMN else state["n_reset_columns"]
    is_read = kind != BETWEEN_COLUMNS and state["is_frame_ok"] and state["n_limits"] == 4
    # a column's pixels are on a line in the picture
    across = n_columns - 1 - column if layout.flip_columns else column
    along, step = (n_rows - 1, -1) if layout.flip_rows else (0, 1)
    x, y, x_step, y_step = state["first_x"] + across, state["first_y"] + along, 0, step
    if layout.swap_frames:
        x, y, x_step, y_step = state["first_x"] + along, state["first_y"] + across, step, 0
    if layout.mirrored:
        x, x_step = layout.width_px - 1 - x, -x_step
    at = (y + row * y_step) * layout.width_px + x + row * x_step
    n: int = count_alike(words, i)
    n_fit = min(n, n_rows - row) if column < n_columns else 0
    if is_read and n_fit > 0:
        samples, step = words[i : i + n_fit], x_step + y_step * layout.width_px
        if kind == RESET_COLUMN:
            keep_reset(samples, layout.sample_shift, at, step, reset.reshape(-1))
        else:
            draw(samples, layout.sample_shift, at, step, reset.reshape(-1), pixels.reshape(-1))
    if is_read:
        state["is_frame_ok"] &= n <= n_fit
        state["n_samples"] = row + n
    return i + n
