"""The compiled loops of the sensor: markers to a picture, the picture to events."""

import math
from typing import NamedTuple

import numba as nb
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]


class Picture(NamedTuple):
    """The irradiance picture; every image is flat, row by row, in DN of an 8-bit frame.

    Attributes:
        width, height: px.
        base: (n,) float32, the picture without markers.
        light: (n,) float32, how bright a white marker is at each pixel.
        image: (n,) float32, the picture now.
        touched: (n,) int32, the pixels where a marker is drawn.
        is_touched: (n,) bool.
        exposed: (n,) float32, sum of ``image - base`` over the ticks of the exposure.
        profile: (m,) float32, brightness of a marker over its squared relative radius.
        profile_scale: entries of ``profile`` per unit of squared relative radius.
        n_touched: (1,) int64, how many of ``touched`` are set.
    """

    width: int
    height: int
    base: Singles
    light: Singles
    image: Singles
    touched: NDArray[np.int32]
    is_touched: NDArray[np.bool_]
    exposed: Singles
    profile: Singles
    profile_scale: float
    n_touched: NDArray[np.int64]


class Pixels(NamedTuple):
    """The state of all event pixels, flat, row by row.

    Attributes:
        signal: (n,) float32, log intensity behind the photoreceptor's low pass.
        reference: (n,) float32, log intensity at the last reset, minus the leak up to ``seen_us``.
        free_us: (n,) float64, end of the refractory period after the last event.
        seen_us: (n,) float64, the moment up to which the leak is in ``reference``.
        on, off: (n,) float32, contrast thresholds.
        leak: (n,) float32, drift of the reference in log units per µs.
        active: (n,) int32, pixels whose signal may change.
        is_active: (n,) bool.
        n_active: (1,) int64, how many of ``active`` are set.
        levels: (m,) float32, lin-log of the intensity; index is intensity times ``level_scale``.
        gains: (m,) float32, share of the way to its input that the low pass goes in one tick.
        level_scale: entries of ``levels`` and ``gains`` per DN.
        hot: (h,) int32, pixels that fire by themselves.
        random: (1,) uint64, counter of the random generator.
    """

    signal: Singles
    reference: Singles
    free_us: Floats
    seen_us: Floats
    on: Singles
    off: Singles
    leak: Singles
    active: NDArray[np.int32]
    is_active: NDArray[np.bool_]
    n_active: NDArray[np.int64]
    levels: Singles
    gains: Singles
    level_scale: float
    hot: NDArray[np.int32]
    random: NDArray[np.uint64]


class Events(NamedTuple):
    """A buffer of events; what does not fit is counted and lost.

    Attributes:
        t: (n,) int64 µs.
        x, y: (n,) int16 px.
        p: (n,) bool, True for ON.
        count: (2,) int64, events held and events lost.
    """

    t: NDArray[np.int64]
    x: NDArray[np.int16]
    y: NDArray[np.int16]
    p: NDArray[np.bool_]
    count: NDArray[np.int64]


@nb.njit(cache=True, nogil=True)
def random_uniform(state: NDArray[np.uint64]) -> float:
    """Next number in [0, 1) of the splitmix64 generator whose counter is ``state[0]``."""
    state[0] += np.uint64(0x9E3779B97F4A7C15)
    z = state[0]
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    return float(z >> np.uint64(11)) / 9007199254740992.0


@nb.njit(cache=True, nogil=True)
def random_poisson(mean: float, state: NDArray[np.uint64]) -> int:
    """A Poisson number, by counting exponential gaps."""
    n = 0
    total = -math.log(1.0 - random_uniform(state))
    while total < mean:
        n += 1
        total -= math.log(1.0 - random_uniform(state))
    return n


@nb.njit(cache=True, nogil=True)
def draw(knots: Floats, u: float, picture: Picture) -> None:
    """Redraw all markers at share ``u`` of the way from the second to the third knot.

    Args:
        knots: (4, n, 6) float64, four equally spaced moments: x, y px, the quadratic form (xx, xy,
            yy) of the marker's outline in 1/px², brightness 0..1.
        u: 0..1.
        picture: updated.
    """
    base, light, image, profile = picture.base, picture.light, picture.image, picture.profile
    touched, is_touched = picture.touched, picture.is_touched
    for i in range(picture.n_touched[0]):
        image[touched[i]] = base[touched[i]]
        is_touched[touched[i]] = False
    n = 0
    u2, u3 = u * u, u * u * u
    w0, w1 = 0.5 * (-u3 + 2.0 * u2 - u), 0.5 * (3.0 * u3 - 5.0 * u2 + 2.0)
    w2, w3 = 0.5 * (-3.0 * u3 + 4.0 * u2 + u), 0.5 * (u3 - u2)
    last = len(profile) - 1
    reach2 = last / picture.profile_scale
    for i in range(knots.shape[1]):
        gain = (1.0 - u) * knots[1, i, 5] + u * knots[2, i, 5]
        if gain <= 0.0:
            continue
        x = w0 * knots[0, i, 0] + w1 * knots[1, i, 0] + w2 * knots[2, i, 0] + w3 * knots[3, i, 0]
        y = w0 * knots[0, i, 1] + w1 * knots[1, i, 1] + w2 * knots[2, i, 1] + w3 * knots[3, i, 1]
        xx = (1.0 - u) * knots[1, i, 2] + u * knots[2, i, 2]
        xy = (1.0 - u) * knots[1, i, 3] + u * knots[2, i, 3]
        yy = (1.0 - u) * knots[1, i, 4] + u * knots[2, i, 4]
        det = xx * yy - xy * xy
        half_x, half_y = math.sqrt(reach2 * yy / det), math.sqrt(reach2 * xx / det)
        top, bottom = max(0, math.ceil(y - half_y)), min(picture.height - 1, math.floor(y + half_y))
        left, right = max(0, math.ceil(x - half_x)), min(picture.width - 1, math.floor(x + half_x))
        for row in range(top, bottom + 1):
            dy = row - y
            for col in range(left, right + 1):
                dx = col - x
                q = (xx * dx * dx + 2.0 * xy * dx * dy + yy * dy * dy) * picture.profile_scale
                k = int(q)
                if k >= last:
                    continue
                pixel = row * picture.width + col
                if not is_touched[pixel]:
                    is_touched[pixel] = True
                    touched[n] = pixel
                    n += 1
                cover = gain * (profile[k] + (q - k) * (profile[k + 1] - profile[k]))
                white = max(light[pixel], base[pixel])
                image[pixel] = min(image[pixel] + cover * (white - base[pixel]), white)
    picture.n_touched[0] = n


@nb.njit(cache=True, nogil=True)
def _wake(pixel: int, pixels: Pixels) -> None:
    if not pixels.is_active[pixel]:
        pixels.is_active[pixel] = True
        pixels.active[pixels.n_active[0]] = pixel
        pixels.n_active[0] += 1


@nb.njit(cache=True, nogil=True)
def wake_leaking(pixels: Pixels, end_us: float) -> None:
    """Make every pixel active whose leak alone fires it before ``end_us``."""
    for i in range(len(pixels.signal)):
        if not pixels.is_active[i]:
            drift = pixels.leak[i] * (end_us - pixels.seen_us[i])
            if pixels.signal[i] - pixels.reference[i] + drift >= pixels.on[i]:
                _wake(i, pixels)


@nb.njit(cache=True, nogil=True)
def _emit(t: float, pixel: int, polarity: bool, width: int, events: Events) -> None:
    n = events.count[0]
    if n >= len(events.t):
        events.count[1] += 1
        return
    events.t[n] = int(t)
    events.x[n] = pixel % width
    events.y[n] = pixel // width
    events.p[n] = polarity
    events.count[0] = n + 1


@nb.njit(cache=True, nogil=True)
def sense(
    image: Singles, width: int, t_us: int, tick_us: int, rest_us: float, refractory_us: float,
    pixels: Pixels, events: Events,
) -> None:
    """Let all active pixels see one tick of the picture and fire where they cross a threshold.

    The signal runs linearly from its value at the begin of the tick to that at its end, so crossing
    times are exact to the µs. In the refractory period the pixel is held in reset, as the circuit
    does: its reference is the signal when the period ends. Pixels that have settled leave ``active``.

    Args:
        image: (n,) float32 DN at the end of the tick.
        width: px of a row.
        t_us: begin of the tick.
        tick_us: its length.
        rest_us: a pixel stays active if its leak can fire it within this time.
        refractory_us: dead time after an event.
        pixels: updated.
        events: appended to, not sorted.
    """
    begin, end = float(t_us), float(t_us + tick_us)
    n_kept = 0
    for slot in range(pixels.n_active[0]):
        i = pixels.active[slot]
        level_at = min(image[i] * pixels.level_scale, len(pixels.levels) - 1.001)
        k = int(level_at)
        goal = pixels.levels[k] + (level_at - k) * (pixels.levels[k + 1] - pixels.levels[k])
        before = pixels.signal[i]
        after = before + pixels.gains[k] * (goal - before)
        slope = (after - before) / tick_us + pixels.leak[i]
        free, start = pixels.free_us[i], begin
        if free >= begin:
            start, distance = free, 0.0
        else:
            distance = before - pixels.reference[i] + pixels.leak[i] * (begin - pixels.seen_us[i])
        while start < end:
            final = distance + slope * (end - start)
            if final >= pixels.on[i]:
                fire = start + max(0.0, pixels.on[i] - distance) / slope if slope > 0 else start
            elif final <= -pixels.off[i]:
                fire = start + max(0.0, pixels.off[i] + distance) / -slope if slope < 0 else start
            else:
                distance = final
                break
            _emit(min(fire, end - 1.0), i, final > 0.0, width, events)
            free = start = fire + refractory_us
            distance = 0.0
        pixels.free_us[i] = free
        pixels.signal[i] = after
        pixels.reference[i] = after - distance
        pixels.seen_us[i] = end
        if (
            abs(goal - after) > 1e-3
            or free >= end
            or distance + pixels.leak[i] * rest_us >= pixels.on[i]
        ):
            pixels.active[n_kept] = i
            n_kept += 1
        else:
            pixels.is_active[i] = False
    pixels.n_active[0] = n_kept


@nb.njit(cache=True, nogil=True)
def add_noise(
    image: Singles, width: int, t_us: int, tick_us: int, shot_hz: float, hot_hz: float,
    refractory_us: float, pixels: Pixels, events: Events,
) -> None:
    """Add shot noise (full rate in the dark, a quarter at white) and hot pixels for one tick."""
    n_pixels, n_hot = len(image), len(pixels.hot)
    n_shot = random_poisson(shot_hz * n_pixels * tick_us * 1e-6, pixels.random)
    n_fire = random_poisson(hot_hz * n_hot * tick_us * 1e-6, pixels.random) if n_hot else 0
    for k in range(n_shot + n_fire):
        if k < n_shot:
            i = int(random_uniform(pixels.random) * n_pixels)
            keep = random_uniform(pixels.random) >= 0.75 * min(image[i] / 255.0, 1.0)
        else:
            i = pixels.hot[int(random_uniform(pixels.random) * n_hot)]
            keep = True
        t = t_us + random_uniform(pixels.random) * tick_us
        polarity = random_uniform(pixels.random) < 0.5
        if keep and t >= pixels.free_us[i]:
            _emit(t, i, polarity, width, events)
            pixels.free_us[i] = t + refractory_us
            pixels.reference[i] = pixels.signal[i]
            pixels.seen_us[i] = float(t_us + tick_us)


@nb.njit(cache=True, nogil=True)
def sort_tick(first: int, t_us: int, tick_us: int, row_us: int, events: Events) -> None:
    """Sort the events from ``first`` on, all of one tick, by time (stable counting sort).

    With ``row_us`` > 0 the events of a row wait for the row's turn, which comes every ``row_us`` µs,
    and share its stamp, as a row-wise readout does.
    """
    n = events.count[0] - first
    t, x, y = events.t[first : first + n].copy(), events.x[first : first + n].copy(), events.y[first : first + n].copy()
    p = events.p[first : first + n].copy()
    place = np.zeros(tick_us + 1, np.int64)
    for i in range(n):
        if row_us > 0:
            phase = (y[i] * 7) % row_us
            t[i] = max(t_us, (t[i] - phase) // row_us * row_us + phase)
        place[t[i] - t_us + 1] += 1
    for k in range(tick_us):
        place[k + 1] += place[k]
    for i in range(n):
        k = first + place[t[i] - t_us]
        place[t[i] - t_us] += 1
        events.t[k], events.x[k], events.y[k], events.p[k] = t[i], x[i], y[i], p[i]


@nb.njit(cache=True, nogil=True)
def advance(
    knots: Floats, moving: bool, first_tick: int, n_ticks: int, ticks_per_knot: int, t_us: int,
    tick_us: int, exposing: bool, shot_hz: float, hot_hz: float, refractory_us: float, row_us: int,
    window_us: int, picture: Picture, pixels: Pixels, events: Events,
) -> None:
    """Run picture and pixels for some ticks within one knot interval.

    Args:
        knots: (4, n, 6) float64, see ``draw``; the interval lies between the second and the third.
        moving: whether any two knots differ.
        first_tick: index of the first tick within the interval.
        n_ticks: how many ticks to run.
        ticks_per_knot: ticks of a whole interval.
        t_us: begin of the first tick.
        tick_us: length of a tick.
        exposing: whether the picture is added to ``picture.exposed``.
        shot_hz, hot_hz: rate of shot noise per pixel and of a hot pixel.
        refractory_us: dead time of a pixel after an event.
        row_us: period of the row-wise readout, 0 for exact stamps.
        window_us: how often leaking pixels are looked for.
        picture, pixels, events: updated.
    """
    for tick in range(first_tick, first_tick + n_ticks):
        begin = t_us + (tick - first_tick) * tick_us
        first = events.count[0]
        if begin % window_us == 0:
            wake_leaking(pixels, begin + window_us)
        if moving:
            for i in range(picture.n_touched[0]):
                _wake(picture.touched[i], pixels)
            draw(knots, (tick + 1) / ticks_per_knot, picture)
            for i in range(picture.n_touched[0]):
                _wake(picture.touched[i], pixels)
        sense(picture.image, picture.width, begin, tick_us, window_us, refractory_us, pixels, events)
        add_noise(picture.image, picture.width, begin, tick_us, shot_hz, hot_hz, refractory_us, pixels, events)
        sort_tick(first, begin, tick_us, row_us, events)
        if exposing:
            for i in range(picture.n_touched[0]):
                pixel = picture.touched[i]
                picture.exposed[pixel] += picture.image[pixel] - picture.base[pixel]
