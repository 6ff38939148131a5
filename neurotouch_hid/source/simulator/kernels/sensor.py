"""The compiled loops of the sensor: a moving picture to events."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_WIDTH_PX
from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.source.simulator.kernels.optics import (
    Lamps,
    Picture,
    draw_markers,
    expose,
    expose_all,
    shine,
)

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Records = NDArray[np.void]

SETTLED = 1e-3  # log units: a pixel this close to its input rests
LEVEL_SCALE = 8.0  # entries of the photoreceptor's tables per DN

PIXEL_DTYPE = np.dtype(
    [
        ("signal", "<f4"),
        ("reference", "<f4"),
        ("on", "<f4"),
        ("off", "<f4"),
        ("leak", "<f4"),
        ("free_us", "<f8"),
        ("seen_us", "<f8"),
    ],
    align=True,
)
"""One event pixel: ``signal`` log intensity behind the photoreceptor's low pass, ``reference`` at
the last reset minus the leak up to ``seen_us``, thresholds ``on`` and ``off``, ``leak`` in log
units per µs, ``free_us`` end of the refractory period."""


class Chip(NamedTuple):
    """The event pixels of one sensor, and the picture on them.

    Attributes:
        picture: the picture on them.
        pixels: (260 * 346,) PIXEL_DTYPE.
        levels: (m,) float32, lin-log of the intensity; index is DN times LEVEL_SCALE.
        gains: (m,) float32, share of the way to its input that the low pass goes in one tick.
        refractory_us: dead time of a pixel after an event.
        hot: (h,) int32, the hot pixels.
        hot_hz: rate of noise events of a hot pixel.
        shot_hz: rate of noise events of a dark pixel.
        random: (1,) uint64, counter of the random generator.
        row_us: period of the row-wise readout, see ``sort_tick``.
        events: (m,) EVENT_DTYPE, filled from the front.
        counts: (1,) COUNTS_DTYPE, the same array as the picture's.
    """

    picture: Picture
    pixels: Records
    levels: Singles
    gains: Singles
    refractory_us: float
    hot: NDArray[np.int32]
    hot_hz: float
    shot_hz: float
    random: NDArray[np.uint64]
    row_us: int
    events: Records
    counts: Records


class Stretch(NamedTuple):
    """A stretch of time within one knot interval.

    Attributes:
        t_us: start of the first tick.
        tick_us: length of a tick.
        first_tick: index of the first tick within the interval.
        n_ticks: how many ticks.
        ticks_per_knot: ticks of a whole interval.
        window_us: how often leaking pixels are looked for.
        moving: whether any two knots differ.
        exposing: whether a frame is being exposed.
    """

    t_us: int
    tick_us: int
    first_tick: int
    n_ticks: int
    ticks_per_knot: int
    window_us: int
    moving: bool
    exposing: bool


@kernel
def random_uniform(state: NDArray[np.uint64]) -> float:
    """Returns the next number in [0, 1) of splitmix64, whose counter is ``state[0]``."""
    state[0] += np.uint64(0x9E3779B97F4A7C15)
    z = state[0]
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    return float(z >> np.uint64(11)) / 9007199254740992.0


@kernel
def random_poisson(mean: float, state: NDArray[np.uint64]) -> int:
    """Returns a Poisson number, by counting exponential gaps."""
    n = 0
    total = -math.log(1.0 - random_uniform(state))
    while total < mean:
        n += 1
        total -= math.log(1.0 - random_uniform(state))
    return n


@kernel
def wake_all(chip: Chip) -> None:
    """Makes every pixel active."""
    canvas, active = chip.picture.canvas, chip.picture.active
    for i in range(len(canvas)):
        canvas[i]["is_active"] = True
        active[i] = i
    chip.counts[0]["active"] = len(canvas)


@kernel
def wake_leaking(end_us: float, chip: Chip) -> None:
    """Makes every pixel active whose leak alone fires it before ``end_us``."""
    pixels, canvas, active = chip.pixels, chip.picture.canvas, chip.picture.active
    counts = chip.counts[0]
    n = counts["active"]
    for i in range(len(pixels)):
        pixel = pixels[i]
        distance = pixel["signal"] - pixel["reference"]
        distance += pixel["leak"] * (end_us - pixel["seen_us"])
        if distance >= pixel["on"] and not canvas[i]["is_active"]:
            canvas[i]["is_active"] = True
            active[n] = i
            n += 1
    counts["active"] = n


@kernel
def _emit(t: float, i: int, polarity: bool, events: Records, counts: np.void) -> None:
    n = counts["events"]
    if n >= len(events):
        counts["lost"] += 1
        return
    event = events[n]
    event["t"], event["x"], event["y"] = int(t), i % SENSOR_WIDTH_PX, i // SENSOR_WIDTH_PX
    event["p"] = polarity
    counts["events"] = n + 1


@kernel(error_model="numpy")
def _fire(
    i: int,
    pixel: np.void,
    before: float,
    after: float,
    begin: float,
    end: float,
    refractory_us: float,
    events: Records,
    counts: np.void,
) -> float:
    """Lets pixel ``i`` fire in a tick in which its signal runs from ``before`` to ``after``.

    Returns:
        How far the signal is above the reference at the end.
    """
    on, off = float(pixel["on"]), float(pixel["off"])
    slope = (after - before) / (end - begin) + pixel["leak"]
    free, start = pixel["free_us"], begin
    if free >= begin:
        start, distance = free, 0.0
    else:
        distance = before - pixel["reference"] + pixel["leak"] * (begin - pixel["seen_us"])
    while start < end:
        final = distance + slope * (end - start)
        if -off < final < on:
            distance = final
            break
        wait = ((on if final > 0.0 else -off) - distance) / slope
        moment = start + wait if wait > 0.0 else start
        _emit(min(moment, end - 1.0), i, final > 0.0, events, counts)
        free = start = moment + refractory_us
        distance = 0.0
    pixel["free_us"], pixel["reference"], pixel["seen_us"] = free, after - distance, end
    return distance


@kernel
def sense(t_us: int, tick_us: int, rest_us: int, chip: Chip) -> None:
    """Runs all active pixels through one tick of the picture; those that cross a threshold fire.

    The signal runs linearly from its value at the start of the tick to that at its end, so crossing
    times are exact to the µs. In the refractory period the pixel is held in reset, as the circuit
    does: its reference is the signal when the period ends. Pixels that have settled go to sleep.

    Args:
        t_us: start of the tick.
        tick_us: its length.
        rest_us: a pixel stays active if its leak can fire it within this time.
        chip: its picture is that at the end of the tick; updated, its new events not sorted.
    """
    pixels, active, canvas = chip.pixels, chip.picture.active, chip.picture.canvas
    levels, gains, refractory_us = chip.levels, chip.gains, chip.refractory_us
    events, counts = chip.events, chip.counts[0]
    begin, end = float(t_us), float(t_us + tick_us)
    n_kept = 0
    for slot in range(counts["active"]):
        i = active[slot]
        pixel, point = pixels[i], canvas[i]
        place = point["image"] * LEVEL_SCALE
        k = np.uint32(place)
        goal = levels[k] + (place - k) * (levels[k + np.uint32(1)] - levels[k])
        before = pixel["signal"]
        after = before + gains[k] * (goal - before)
        pixel["signal"] = after
        distance = after - pixel["reference"] + pixel["leak"] * (end - pixel["seen_us"])
        if pixel["free_us"] >= begin or not -pixel["off"] < distance < pixel["on"]:
            distance = _fire(i, pixel, before, after, begin, end, refractory_us, events, counts)
        if (
            abs(goal - after) > SETTLED
            or pixel["free_us"] >= end
            or distance + pixel["leak"] * rest_us >= pixel["on"]
        ):
            active[n_kept] = i
            n_kept += 1
        else:
            point["is_active"] = False
    counts["active"] = n_kept


@kernel
def add_noise(t_us: int, tick_us: int, chip: Chip) -> None:
    """Adds shot noise (full rate in the dark, a quarter at white) and hot pixels for one tick.

    Args:
        t_us: start of the tick.
        tick_us: its length.
        chip: updated, its new events not sorted.
    """
    pixels, hot, random = chip.pixels, chip.hot, chip.random
    n_shot = random_poisson(chip.shot_hz * len(pixels) * tick_us * 1e-6, random)
    n_hot = random_poisson(chip.hot_hz * len(hot) * tick_us * 1e-6, random)
    for k in range(n_shot + n_hot):
        t = t_us + random_uniform(random) * tick_us
        polarity = random_uniform(random) < 0.5
        if k < n_shot:
            i = int(random_uniform(random) * len(pixels))
            if random_uniform(random) < 0.75 / 255.0 * chip.picture.canvas[i]["image"]:
                continue
        else:
            i = int(hot[int(random_uniform(random) * len(hot))])
        pixel = pixels[i]
        if t >= pixel["free_us"]:
            _emit(t, i, polarity, chip.events, chip.counts[0])
            pixel["free_us"] = t + chip.refractory_us
            pixel["reference"] = pixel["signal"]
            pixel["seen_us"] = float(t_us + tick_us)


@kernel
def sort_tick(first: int, t_us: int, tick_us: int, row_us: int, events: Records, end: int) -> None:
    """Sorts the events from ``first`` to ``end``, all of one tick, by time (stable counting sort).

    With ``row_us`` > 0 the events of a row wait until the row is read, every ``row_us`` µs, and
    share its stamp, as in a row-wise readout.
    """
    part = events[first:end].copy()
    place = np.zeros(tick_us + 1, np.int64)
    for i in range(len(part)):
        event = part[i]
        if row_us > 0:
            phase = (event["y"] * 7) % row_us
            turn = (event["t"] - phase + row_us - 1) // row_us * row_us + phase
            event["t"] = min(turn, t_us + tick_us - 1)
        place[event["t"] - t_us + 1] += 1
    for k in range(tick_us):
        place[k + 1] += place[k]
    for i in range(len(part)):
        k = part[i]["t"] - t_us
        events[first + place[k]] = part[i]
        place[k] += 1


@kernel
def run_sensor(knots: Floats, stretch: Stretch, lamps: Lamps, chip: Chip) -> None:
    """Runs picture and pixels through a stretch of time.

    Args:
        knots: (4, n, 6) float64, see ``draw_markers``; the interval is from the second to third.
        stretch: when.
        lamps: the light of the interval.
        chip: updated; its new events are in order of time.
    """
    tick_us, window_us = stretch.tick_us, stretch.window_us
    for tick in range(stretch.n_ticks):
        begin = stretch.t_us + tick * tick_us
        place = stretch.first_tick + tick
        u = (place + 1) / stretch.ticks_per_knot
        first = chip.counts[0]["events"]
        if begin % window_us == 0:
            wake_leaking(float(begin + window_us), chip)
        if stretch.moving or lamps.changes:
            draw_markers(knots, u, chip.picture)
        if lamps.changes:
            shine(chip.picture, lamps, place, u)
            wake_all(chip)
        sense(begin, tick_us, window_us, chip)
        add_noise(begin, tick_us, chip)
        sort_tick(first, begin, tick_us, chip.row_us, chip.events, chip.counts[0]["events"])
        if stretch.exposing and lamps.changes:
            expose_all(chip.picture)
        elif stretch.exposing:
            expose(chip.picture)
