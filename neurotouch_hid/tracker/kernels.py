"""The compiled loops of the tracker: the event filter and the neighbour check.

State: one row of 8 float64 (64 bytes, one cache line) per marker. Columns: position X, Y (px),
velocity VX, VY (px/s), the covariance A = var(position) (px²), B = cov(position, velocity) (px²/s),
C = var(velocity) (px²/s²), the same for x and y, and the moment T (µs) they all belong to.

Grid: square cells of ``CELL_PX`` with a border of one cell; each marker hangs in the doubly linked
list of its cell (``head`` per cell, ``link[:, 0]`` next, ``link[:, 1]`` previous, ``cell`` index).
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

X, Y, VX, VY, A, B, C, T = range(8)
CELL_PX = 12  # an event looks at the 2 x 2 cells around it: exact for gates up to half a cell
GRID_COLUMNS = 31  # 346 px in cells, and a border on both sides
GRID_ROWS = 24  # 260 px in cells, and a border on both sides
SECOND = 1e-6  # in µs


@njit(cache=True, nogil=True, inline="always")
def _cell_of(x: float, y: float) -> int:
    column = min(max(int(math.floor(x / CELL_PX)) + 1, 0), GRID_COLUMNS - 1)
    row = min(max(int(math.floor(y / CELL_PX)) + 1, 0), GRID_ROWS - 1)
    return row * GRID_COLUMNS + column


@njit(cache=True, nogil=True)
def seat(
    i: int,
    state: NDArray[np.float64],
    head: NDArray[np.int16],
    link: NDArray[np.int16],
    cell: NDArray[np.int16],
) -> None:
    """Hang marker ``i`` in the cell of its position; a marker that is in no cell has ``cell`` -1."""
    new, old = _cell_of(state[i, X], state[i, Y]), cell[i]
    if new == old:
        return
    after, before = link[i, 0], link[i, 1]
    if old >= 0:
        if before >= 0:
            link[before, 0] = after
        else:
            head[old] = after
        if after >= 0:
            link[after, 1] = before
    first = head[new]
    link[i, 0], link[i, 1] = first, -1
    if first >= 0:
        link[first, 1] = i
    head[new] = i
    cell[i] = new


@njit(cache=True, nogil=True)
def nearest(
    x: int,
    y: int,
    gate_px2: float,
    state: NDArray[np.float64],
    head: NDArray[np.int16],
    link: NDArray[np.int16],
) -> int:
    """The marker nearest to pixel (x, y) among those nearer than the gate, or -1."""
    corner = (y + CELL_PX // 2) // CELL_PX * GRID_COLUMNS + (x + CELL_PX // 2) // CELL_PX
    best, best_px2 = -1, gate_px2
    for offset in (0, 1, GRID_COLUMNS, GRID_COLUMNS + 1):
        i = head[corner + offset]
        while i >= 0:
            dx, dy = x - state[i, X], y - state[i, Y]
            px2 = dx * dx + dy * dy
            if px2 < best_px2:
                best, best_px2 = i, px2
            i = link[i, 0]
    return best


@njit(cache=True, nogil=True)
def filter_events(
    events: NDArray[np.void],
    start: int,
    until_us: int,
    state: NDArray[np.float64],
    head: NDArray[np.int16],
    link: NDArray[np.int16],
    cell: NDArray[np.int16],
    hits: NDArray[np.int32],
    gate_px: float,
    r_px2: float,
    spread_px: float,
    q_x: float,
    q_v: float,
    memory_s: float,
    quiet_s: float,
) -> int:
    """Give each event before ``until_us`` to the nearest marker in the gate, one by one.

    A linear Kalman filter with constant velocity [NT, "Marker Tracking"]. With isotropic noise the
    two axes share one 2 x 2 covariance, so that an update needs a single division.

    Returns:
        The index of the first event at or after ``until_us``.
    """
    n = len(events)
    gate_px2 = gate_px * gate_px
    forget = 1.0 / memory_s
    tail = 1.0 / (spread_px * spread_px)
    while start < n and events[start].t < until_us:
        e = events[start]
        start += 1
        x, y = int(e.x), int(e.y)
        i = nearest(x, y, gate_px2, state, head, link)
        if i < 0:
            continue
        s = state[i]
        t = float(e.t)
        elapsed = (t - s[T]) * SECOND
        dt = min(elapsed, memory_s)
        keep = 1.0 - dt * forget
        step = 0.5 * dt * (1.0 + keep)
        # What makes no events does not move: uncertainty stops growing when a marker is quiet.
        dt = min(elapsed, quiet_s)
        b = s[B] + dt * s[C]
        a = s[A] + dt * (s[B] + b) + q_x * dt
        c = s[C] + q_v * dt
        px, py = s[X] + s[VX] * step, s[Y] + s[VY] * step
        dx, dy = x - px, y - py
        # Heavy-tailed noise: an event far from the marker is more likely to be nobody's.
        far = (dx * dx + dy * dy) * tail
        inverse = 1.0 / (a + r_px2 * (1.0 + far * far))
        k1, k2 = a * inverse, b * inverse
        s[X], s[Y] = px + k1 * dx, py + k1 * dy
        s[VX], s[VY] = s[VX] * keep + k2 * dx, s[VY] * keep + k2 * dy
        s[A], s[B], s[C] = a - k1 * a, b - k1 * b, c - k2 * b
        s[T] = t
        hits[i] += 1
        seat(i, state, head, link, cell)
    return start


@njit(cache=True, nogil=True)
def advance(
    events: NDArray[np.void],
    start: int,
    until_us: int,
    state: NDArray[np.float64],
    head: NDArray[np.int16],
    link: NDArray[np.int16],
    cell: NDArray[np.int16],
    hits: NDArray[np.int32],
    rest_px: NDArray[np.float64],
    neighbours: NDArray[np.intp],
    lost: NDArray[np.bool_],
    past_px: NDArray[np.float64],
    past_us: NDArray[np.int64],
    check_us: int,
    clock: NDArray[np.int64],
    gate_px: float,
    r_px2: float,
    spread_px: float,
    q_x: float,
    q_v: float,
    memory_s: float,
    quiet_s: float,
    max_stray_px: float,
    max_stray_ratio: float,
) -> int:
    """Filter the events before ``until_us`` and check the neighbours every ``check_us``.

    Checks happen at multiples of ``check_us``, however the stream is cut into slices. Each leaves
    the positions in the ring ``past_px`` (k, n, 2) with their moments in ``past_us`` (k,).

    Args:
        clock: (2,) int64: moment of the next check, number of checks done.

    Returns:
        The index of the first event at or after ``until_us``.
    """
    while clock[0] <= until_us:
        start = filter_events(
            events,
            start,
            clock[0],
            state,
            head,
            link,
            cell,
            hits,
            gate_px,
            r_px2,
            spread_px,
            q_x,
            q_v,
            memory_s,
            quiet_s,
        )
        slot = clock[1] % len(past_us)
        past_us[slot] = clock[0]
        predict(float(clock[0]), memory_s, state, past_px[slot])
        check_neighbours(
            float(clock[0]),
            past_px[slot],
            rest_px,
            neighbours,
            max_stray_px,
            max_stray_ratio,
            state,
            head,
            link,
            cell,
            lost,
            hits,
        )
        clock[0] += check_us
        clock[1] += 1
    return filter_events(
        events,
        start,
        until_us,
        state,
        head,
        link,
        cell,
        hits,
        gate_px,
        r_px2,
        spread_px,
        q_x,
        q_v,
        memory_s,
        quiet_s,
    )


@njit(cache=True, nogil=True)
def expect(
    position_px: NDArray[np.float64],
    rest_px: NDArray[np.float64],
    neighbours: NDArray[np.intp],
    usable: NDArray[np.bool_],
    expected_px: NDArray[np.float64],
    stray_px: NDArray[np.float64],
    spread_px: NDArray[np.float64],
) -> None:
    """Where each marker should be by its neighbours: rest plus their median displacement.

    Args:
        position_px, rest_px: (n, 2) float64.
        neighbours: (n, 8) intp, -1 where there is none.
        usable: (n,) bool: neighbours that have a say.
        expected_px: (n, 2), filled in.
        stray_px: (n,), filled in: distance of the marker from there (largest component).
        spread_px: (n,), filled in: median deviation of the neighbours (largest component); -1 if
            fewer than three have a say.
    """
    values = np.empty(8)
    for i in range(len(position_px)):
        stray_px[i], spread_px[i] = 0.0, -1.0
        for axis in range(2):
            n = 0
            for j in neighbours[i]:
                if j >= 0 and usable[j]:
                    v = position_px[j, axis] - rest_px[j, axis]
                    k = n
                    while k > 0 and values[k - 1] > v:
                        values[k] = values[k - 1]
                        k -= 1
                    values[k] = v
                    n += 1
            if n < 3:
                expected_px[i, axis] = position_px[i, axis]
                continue
            median = 0.5 * (values[(n - 1) // 2] + values[n // 2])
            expected_px[i, axis] = rest_px[i, axis] + median
            stray_px[i] = max(stray_px[i], abs(position_px[i, axis] - expected_px[i, axis]))
            # Half the distance between the quartiles stands for the median deviation.
            spread_px[i] = max(spread_px[i], 0.5 * (values[n - 1 - n // 4] - values[n // 4]))


@njit(cache=True, nogil=True)
def check_neighbours(
    t_us: float,
    position_px: NDArray[np.float64],
    rest_px: NDArray[np.float64],
    neighbours: NDArray[np.intp],
    max_stray_px: float,
    max_stray_ratio: float,
    state: NDArray[np.float64],
    head: NDArray[np.int16],
    link: NDArray[np.int16],
    cell: NDArray[np.int16],
    lost: NDArray[np.bool_],
    hits: NDArray[np.int32],
) -> None:
    """Seat anew what strays from its neighbours; ``position_px`` is corrected along."""
    n = len(state)
    expected = np.empty((n, 2))
    stray, spread = np.empty(n), np.empty(n)
    expect(position_px, rest_px, neighbours, ~lost, expected, stray, spread)
    for i in range(n):
        if spread[i] >= 0.0 and stray[i] > max_stray_px + max_stray_ratio * spread[i]:
            place(i, expected[i, 0], expected[i, 1], 0.0, 0.0, 4.0, t_us, state, head, link, cell)
            position_px[i] = expected[i]
            lost[i] = True
            hits[i] = 0


@njit(cache=True, nogil=True)
def place(
    i: int,
    x: float,
    y: float,
    vx: float,
    vy: float,
    variance_px2: float,
    t_us: float,
    state: NDArray[np.float64],
    head: NDArray[np.int16],
    link: NDArray[np.int16],
    cell: NDArray[np.int16],
) -> None:
    """Put marker ``i`` where it is known to be, with what is known about its motion."""
    s = state[i]
    s[X], s[Y], s[VX], s[VY], s[T] = x, y, vx, vy, t_us
    s[A], s[B], s[C] = variance_px2, 0.0, 100.0
    seat(i, state, head, link, cell)


@njit(cache=True, nogil=True)
def predict(
    t_us: float, memory_s: float, state: NDArray[np.float64], out_px: NDArray[np.float64]
) -> None:
    """Where every marker is at ``t_us``: the velocity fades with ``memory_s`` since its last event."""
    for i in range(len(state)):
        dt = min((t_us - state[i, T]) * SECOND, memory_s)
        step = dt * (1.0 - 0.5 * dt / memory_s)
        out_px[i, 0] = state[i, X] + state[i, VX] * step
        out_px[i, 1] = state[i, Y] + state[i, VY] * step
