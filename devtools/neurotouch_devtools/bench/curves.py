"""Draws latency over the rate of events, and the tracker's cost over the number of markers."""

import math
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator
from numpy.typing import NDArray

from neurotouch_hid.evaluation.accuracy.report.style import (
    BLUE,
    GREEN,
    MUTED,
    VERMILION,
    add_grid,
    apply_style,
    render_svg,
)
from neurotouch_hid.evaluation.speed.pace import choose_device, measure_live
from neurotouch_hid.evaluation.speed.workload import SPREAD_PX, TOUR_US, DenseSource, load_scene
from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.partial_file import write_whole
from neurotouch_hid.tracker import TrackerConfig
from neurotouch_hid.tracker.config import make_tracks
from neurotouch_hid.tracker.kernels import filter as kernels
from neurotouch_hid.tracker.kernels import tracks as track_kernels

RATES: Final = (0.1e6, 0.3e6, 1e6, 3e6, 6e6, 12e6)
"""Events a second: a slow push to the sensor's ceiling."""
NUMBERS: Final = (50, 100, 177, 350, 700, 1000, 1400, 2000)
"""Numbers of markers; 2000 are 6.7 px apart, closer than the gates of two allow."""
RANKS: Final = ("p50", "p99", "p99.9")

_SECONDS = 10.0
_SLICE_US = 4_000
_N_EVENTS = 400_000
_SWING_PX, _SWING_US = 2.0, 200_000  # 63 px/s: a lively hand


def write_curves(
    folder: Path, latency: Mapping[float, Mapping[str, float]], cost: Mapping[int, float]
) -> tuple[Path, ...]:
    """Draws both curves into a folder.

    Args:
        folder: created if missing.
        latency: result of ``measure_rates``.
        cost: ns an event, by number of markers.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with apply_style():
        pictures = {"latency.svg": _draw_rates(latency), "markers.svg": _draw_cost(cost)}
        for name, figure in pictures.items():
            write_whole(folder / name, render_svg(figure).encode())
    return tuple(folder / name for name in pictures)


def measure_rates(
    progress: Callable[[str], None],
    rates: tuple[float, ...] = RATES,
    seconds: float = _SECONDS,
    length_us: int = TOUR_US,
) -> dict[float, dict[str, float]]:
    """Measures the latency of the live pipeline in ms, by events a second.

    Args:
        progress: called with a sentence at each step.
        rates: events a second.
        seconds: length of each run.
        length_us: length of the scene, which repeats.
    """
    kind = choose_device()
    scene = load_scene("tour", _SLICE_US, length_us)
    latency = {}
    for rate in rates:
        progress(f"Playing {rate / 1e6:g} million events/s")
        run = measure_live(DenseSource(scene, seconds, rate), kind)
        latency[rate] = run["latency_ms"]
    return latency


def measure_markers(n: int) -> float:
    """Measures the filter's processor time per event in ns, with n markers.

    The markers are on a lattice that fills the sensor, swing together, and make a million events/s.
    """
    rest_px, neighbours = lay_lattice(n)
    config = TrackerConfig()
    tracks, tuning = make_tracks(neighbours, config), config.tuning()
    tracks.rest_px[:] = rest_px
    track_kernels.place(np.arange(n), rest_px, 1.0, 0.0, tracks, tuning)
    events = _swing(rest_px)
    half = len(events) // 2
    where = np.empty((n, 2), np.float32), np.empty(n, np.bool_)
    kernels.filter_slice(
        tracks, tuning, events[:half].copy(), 0, int(events["t"][half]), *where
    )  # warm
    rest = events[half:].copy()
    begun_s = time.thread_time()
    kernels.filter_slice(tracks, tuning, rest, 0, int(rest["t"][-1]) + 1, *where)
    return (time.thread_time() - begun_s) / len(rest) * 1e9


def lay_lattice(n: int) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Returns a square lattice that fills the sensor.

    Returns:
        (n, 2) px, and (n, 8) indices of the neighbours, -1 where there is none.
    """
    columns = math.ceil(math.sqrt(n * SENSOR_WIDTH_PX / SENSOR_HEIGHT_PX))
    rows = math.ceil(n / columns)
    row, column = np.divmod(np.arange(n), columns)
    x = (column + 0.5) * SENSOR_WIDTH_PX / columns
    y = (row + 0.5) * SENSOR_HEIGHT_PX / rows
    around = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]
    neighbours = np.full((n, len(around)), -1, np.intp)
    for k, (i, j) in enumerate(around):
        other = (row + i) * columns + column + j
        is_there = (row + i >= 0) & (column + j >= 0) & (column + j < columns) & (other < n)
        neighbours[is_there, k] = other[is_there]
    return np.column_stack([x, y]), neighbours


def _swing(rest_px: NDArray[np.float64]) -> NDArray[np.void]:
    rng = np.random.default_rng(len(rest_px))
    events = np.zeros(_N_EVENTS, EVENT_DTYPE)
    t = np.arange(1, _N_EVENTS + 1)
    phase = 2.0 * np.pi * t / _SWING_US
    at = rest_px[rng.integers(len(rest_px), size=_N_EVENTS)]
    at = at + rng.normal(0.0, SPREAD_PX, at.shape) + _SWING_PX * np.sin(phase)[:, None]
    events["t"], events["p"] = t, rng.random(_N_EVENTS) < 0.5
    events["x"] = np.clip(np.rint(at[:, 0]), 0, SENSOR_WIDTH_PX - 1)
    events["y"] = np.clip(np.rint(at[:, 1]), 0, SENSOR_HEIGHT_PX - 1)
    return events


def _draw_rates(latency: Mapping[float, Mapping[str, float]]) -> Figure:
    figure = Figure(figsize=(7.2, 4.2))
    axes = figure.subplots()
    looks = zip(RANKS, (BLUE, GREEN, VERMILION), ("o", "s", "^"), strict=True)
    for rank, colour, marker in looks:
        values = [each[rank] for each in latency.values()]
        millions = [rate / 1e6 for rate in latency]
        axes.plot(millions, values, color=colour, marker=marker, label=rank)
    axes.set(xscale="log", yscale="log", xlabel="million events/s", ylabel="ms")
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_title("Last event of a slice to the write to the pad, 250 slices/s")
    _finish(figure, [rate / 1e6 for rate in latency])
    return figure


def _draw_cost(cost: Mapping[int, float]) -> Figure:
    figure = Figure(figsize=(7.2, 4.2))
    axes = figure.subplots()
    axes.plot(list(cost), list(cost.values()), color=BLUE, marker="o")
    axes.axvline(177, color=MUTED, lw=1.0, ls=":")
    axes.set(xscale="log", xlabel="markers (dotted: ours)", ylabel="ns/event", ylim=(0, None))
    axes.set_title("Tracker, its checks included, at 1 million events/s")
    _finish(figure, list(cost))
    return figure


def _finish(figure: Figure, ticks: list[float] | list[int]) -> None:
    axes = figure.axes[0]
    add_grid(axes)
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    if axes.get_legend_handles_labels()[0]:
        axes.legend()
