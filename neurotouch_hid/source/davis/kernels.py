"""The compiled loop from the camera's words to events and frames.

A word is 16 bits, little-endian [libcaer ``davis_common.h``]: ``1ttt…`` is the low 15 bits of the
time in µs; else three bits of code and twelve of data. All that is known between two words lies in
arrays, so the stream may be cut anywhere.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX

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

# Layout: how this camera's addresses lie in the picture, (8,) int64.
DVS_COLUMNS, DVS_ROWS, DVS_SWAP, APS_SWAP, FLIP_COLUMNS, FLIP_ROWS, MIRRORED, N_LAYOUT = range(8)

# State, (N_STATE,) int64.
(
    SYNCED,  # 1 once the timestamp reset of the start has been seen
    ORIGIN,  # µs of the stream at the camera's time 0
    BASE,  # µs that the wraps have added up to
    NOW,  # µs of the stream at the last word; never goes back
    Y,  # the last row word, -1 if none or a wrong one
    IN_FRAME,
    FRAME_OK,
    ROI_COUNT,  # values of the region seen so far
    ROI_BYTE,  # the high byte of the next
    ROI_X,
    ROI_Y,
    ROI_X_END,
    ROI_Y_END,
    KIND,  # 0 reset column, 1 signal column, -1 between columns
    N_RESET,  # columns read so far
    N_SIGNAL,
    N_SAMPLES,  # in this column
    FRAME_BEGIN_US,
    FRAME_END_US,
    EXPOSURE_BEGIN_US,
    EXPOSURE_END_US,
    N_STATE,
) = range(22)

# Counters, (N_COUNTERS,) int64.
(
    BAD_ROWS,
    BAD_COLUMNS,
    ORPHANS,  # events without a row
    BACKWARD,  # times that did not go on
    UNKNOWN,  # words that mean nothing
    RESETS,  # timestamp resets after the first
    BAD_FRAMES,
    N_COUNTERS,
) = range(8)

TOO_BRIGHT = 384  # a reset value below this is one that the light has already pulled down
WHITE = 1023


@njit(cache=True, nogil=True)
def decode(
    words: NDArray[np.uint16],
    start: int,
    layout: NDArray[np.int64],
    state: NDArray[np.int64],
    counters: NDArray[np.int64],
    events: NDArray[np.void],
    n: int,
    reset: NDArray[np.int16],
    pixels: NDArray[np.uint8],
) -> tuple[int, int, bool]:
    """Reads words up to the end, or up to the end of a frame.

    Args:
        words: (w,) uint16.
        start: the first word to read.
        layout: see above.
        state: see above; carried from call to call.
        counters: see above; counted up.
        events: EVENT_DTYPE, long enough for all words.
        n: events that are in it already.
        reset: (260, 346) int16, the reset values of the frame that is being read.
        pixels: (260, 346) uint8, that frame.

    Returns:
        The first word not read, the number of events, and whether a frame is complete.
    """
    columns, rows = layout[DVS_COLUMNS], layout[DVS_ROWS]
    swap, mirrored = layout[DVS_SWAP] != 0, layout[MIRRORED] != 0
    now, y = state[NOW], state[Y]
    origin = state[ORIGIN] + state[BASE]
    i = start
    if not state[SYNCED]:  # what comes before the reset is left over from before
        while i < len(words) and words[i] != RESET:
            i += 1
        if i == len(words):
            return i, n, False
        state[SYNCED] = 1
        i += 1
    while i < len(words):
        word = words[i]
        i += 1
        code, data = word >> 12, np.int64(word & 0xFFF)
        if code & 8:
            t = origin + np.int64(word & 0x7FFF)
            if t <= now:
                counters[BACKWARD] += 1
            else:
                now = t
        elif code in (COLUMN_OFF, COLUMN_ON):
            if data >= columns:
                counters[BAD_COLUMNS] += 1
            elif y < 0:
                counters[ORPHANS] += 1
            else:
                event = events[n]
                event.t = now
                x_px, y_px = (y, data) if swap else (data, y)
                event.x = SENSOR_WIDTH_PX - 1 - x_px if mirrored else x_px
                event.y = y_px
                event.p = code == COLUMN_ON
                n += 1
        elif code == ROW:
            y = data
            if data >= rows:
                counters[BAD_ROWS] += 1
                y = -1
        elif code == SAMPLE:
            if state[IN_FRAME]:
                i = _take_samples(words, i - 1, layout, state, reset, pixels)
        elif code == WRAP:
            state[BASE] += data * WRAP_US
            origin = state[ORIGIN] + state[BASE]
            if origin <= now:
                counters[BACKWARD] += 1
            now = max(now, origin)
        elif code == SPECIAL and data == RESET:
            # The stream's time goes on from where the camera started again.
            counters[RESETS] += 1
            counters[BAD_FRAMES] += state[IN_FRAME]
            state[IN_FRAME] = 0
            state[ORIGIN], state[BASE] = now, 0
            origin, y = now, -1
        elif code == SPECIAL:
            state[NOW] = now
            if _take_special(data, layout, state, counters):
                state[Y] = y
                return i, n, True
        elif code == BYTE:
            kind = data >> 8
            if kind == ROI_HIGH:
                state[ROI_BYTE] = data & 0xFF
            elif kind == ROI_LOW:
                _take_region(data & 0xFF, state, pixels)
            elif kind not in (IMU_BYTE, IMU_SETUP):
                counters[UNKNOWN] += 1
        elif data >> 10:  # SLICE: parts of the exposure in clock cycles, only 0 is in use
            counters[UNKNOWN] += 1
    state[NOW], state[Y] = now, y
    return i, n, False


@njit(cache=True, nogil=True)
def _take_special(
    data: int, layout: NDArray[np.int64], state: NDArray[np.int64], counters: NDArray[np.int64]
) -> bool:
    """A special word that is no timestamp reset; True if it completes a frame."""
    if data in (FRAME_GLOBAL, FRAME_ROLLING):
        counters[BAD_FRAMES] += state[IN_FRAME]
        now = state[NOW]
        state[IN_FRAME], state[FRAME_OK] = 1, 1
        state[ROI_COUNT], state[KIND], state[N_RESET], state[N_SIGNAL] = 0, -1, 0, 0
        state[FRAME_BEGIN_US], state[EXPOSURE_BEGIN_US], state[EXPOSURE_END_US] = now, -1, -1
    elif data in (COLUMN_RESET, COLUMN_SIGNAL):
        is_early = data == COLUMN_SIGNAL and state[N_SIGNAL] >= state[N_RESET]
        if state[KIND] >= 0 or is_early:  # the one before has no end, or no reset value is known
            state[FRAME_OK] = 0
        state[KIND], state[N_SAMPLES] = data - COLUMN_RESET, 0
    elif data == COLUMN_END:
        if state[KIND] < 0 or state[N_SAMPLES] != _expected(layout, state, rows=True):
            state[FRAME_OK] = 0
        if state[KIND] >= 0:
            state[N_RESET + state[KIND]] += 1
        state[KIND] = -1
    elif data == EXPOSURE_BEGIN:
        state[EXPOSURE_BEGIN_US] = state[NOW]
    elif data == EXPOSURE_END:
        state[EXPOSURE_END_US] = state[NOW]
    elif data == FRAME_END:
        whole: bool = _end_frame(layout, state, counters)
        return whole
    elif not (
        INPUT_FIRST <= data <= INPUT_LAST
        or data in (IMU_BEGIN, IMU_END)
        or GENERATOR_FIRST <= data <= GENERATOR_LAST
    ):
        counters[UNKNOWN] += 1
    return False


@njit(cache=True, nogil=True)
def _end_frame(
    layout: NDArray[np.int64], state: NDArray[np.int64], counters: NDArray[np.int64]
) -> bool:
    if not state[IN_FRAME]:
        return False
    state[IN_FRAME] = 0
    n_columns = _expected(layout, state, rows=False)
    is_whole = (
        state[FRAME_OK] == 1
        and state[ROI_COUNT] == 4
        and state[KIND] < 0
        and state[N_RESET] == n_columns
        and state[N_SIGNAL] == n_columns
    )
    if not is_whole:
        counters[BAD_FRAMES] += 1
        return False
    state[FRAME_END_US] = state[NOW]
    if state[EXPOSURE_END_US] < 0:
        state[EXPOSURE_END_US] = state[NOW]
    if not 0 <= state[EXPOSURE_BEGIN_US] <= state[EXPOSURE_END_US]:
        state[EXPOSURE_BEGIN_US] = state[FRAME_BEGIN_US]
    return True


@njit(cache=True, nogil=True)
def _expected(layout: NDArray[np.int64], state: NDArray[np.int64], rows: bool) -> int:
    """The rows, or columns, of the frame's region as the chip counts them."""
    first = ROI_X if rows == (layout[APS_SWAP] != 0) else ROI_Y
    count: int = state[first + 2] - state[first] + 1
    return count


@njit(cache=True, nogil=True)
def _take_region(low: int, state: NDArray[np.int64], pixels: NDArray[np.uint8]) -> None:
    """The low byte of a limit of the frame's region; the fourth one completes it."""
    if not state[IN_FRAME] or state[ROI_COUNT] > 3:
        return
    state[ROI_X + state[ROI_COUNT]] = state[ROI_BYTE] << 8 | low
    state[ROI_COUNT] += 1
    if state[ROI_COUNT] < 4:
        return
    if not (
        state[ROI_X] <= state[ROI_X_END] < SENSOR_WIDTH_PX
        and state[ROI_Y] <= state[ROI_Y_END] < SENSOR_HEIGHT_PX
    ):
        state[FRAME_OK] = 0
    elif (
        state[ROI_X_END] - state[ROI_X] + 1 < SENSOR_WIDTH_PX
        or state[ROI_Y_END] - state[ROI_Y] + 1 < SENSOR_HEIGHT_PX
    ):
        pixels[:] = 0


@njit(cache=True, nogil=True)
def _take_samples(
    words: NDArray[np.uint16],
    i: int,
    layout: NDArray[np.int64],
    state: NDArray[np.int64],
    reset: NDArray[np.int16],
    pixels: NDArray[np.uint8],
) -> int:
    """Readings of the ADC up to the next other word, put to their pixels; returns where that is.

    What is too many for the frame goes nowhere, and the frame counts as bad.
    """
    kind, row = state[KIND], state[N_SAMPLES]
    n_columns = _expected(layout, state, rows=False)
    n_rows = _expected(layout, state, rows=True)
    column = state[N_RESET + max(kind, 0)]
    is_read = kind >= 0 and state[FRAME_OK] == 1 and state[ROI_COUNT] == 4
    # a column's pixels lie on a line in the picture
    across = n_columns - 1 - column if layout[FLIP_COLUMNS] else column
    along, step = (n_rows - 1, -1) if layout[FLIP_ROWS] else (0, 1)
    x, y, x_step, y_step = state[ROI_X] + across, state[ROI_Y] + along, 0, step
    if layout[APS_SWAP]:
        x, y, x_step, y_step = state[ROI_X] + along, state[ROI_Y] + across, step, 0
    if layout[MIRRORED]:
        x, x_step = SENSOR_WIDTH_PX - 1 - x, -x_step
    x, y = x + row * x_step, y + row * y_step
    while i < len(words) and words[i] >> 12 == SAMPLE:
        if is_read and column < n_columns and row < n_rows:
            value = np.int64(words[i] & 0x3FF)
            if kind == 0:
                reset[y, x] = value
            else:
                before = np.int64(reset[y, x])
                light = WHITE if before < TOO_BRIGHT or value == 0 else max(int(before - value), 0)
                pixels[y, x] = min(255, (light + 3) >> 2)  # as the vendor's library rounds
            x, y = x + x_step, y + y_step
        elif is_read:
            state[FRAME_OK] = 0
        row += 1
        i += 1
    if is_read:
        state[N_SAMPLES] = row
    return i
