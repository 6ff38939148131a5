"""Nuisances of the sensor: exposure, bad pixels, noise, events made by reading frames."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.events import join_events, pick_events
from neurotouch_hid.messages import EVENT_DTYPE, SENSOR_HEIGHT_PX
from neurotouch_hid.source.simulator.setup import Piece, Setup

ROW_US = 35.2  # of a row's read, measured at a real DAVIS-346
SWEEP_US = ROW_US * SENSOR_HEIGHT_PX
READ_GREY_DN = np.array([0.0, 16.0, 80.0, 144.0, 208.0, 240.0, 255.0])
READ_EVENTS = 0.5 * np.array([0.0002, 0.0003, 0.0011, 0.0019, 0.0024, 0.0071, 0.0071])
"""ON events per pixel and sweep, by its brightness in a frame: measured, two sweeps a frame."""


def overexposed(setup: Setup, times: float) -> Setup:
    """Makes frames ``times`` times as bright, so that white dots saturate."""
    return setup.configured("sensor", frame_gain=times)


def underexposed(setup: Setup, times: float) -> Setup:
    """Makes frames ``times`` times as dark."""
    return setup.configured("sensor", frame_gain=1.0 / times)


def frame_noise(setup: Setup, dn: float) -> Setup:
    """Adds noise to each pixel of each frame."""
    return setup.configured("sensor", read_noise_dn=dn)


def hot(setup: Setup, number: float) -> Setup:
    """Makes pixels fire by themselves, 200 times a second each."""
    return setup.configured("sensor", n_hot=round(number))


def noise(setup: Setup, hz: float) -> Setup:
    """Makes each dark pixel fire by itself so often; a white one a quarter as often."""
    return setup.configured("sensor", shot_hz=hz)


def mismatch(setup: Setup, log_units: float) -> Setup:
    """Spreads the contrast thresholds of the pixels by this standard deviation."""
    return setup.configured("sensor", contrast_spread=log_units)


def threshold(setup: Setup, log_units: float) -> Setup:
    """Sets the mean contrast that a pixel needs for an event."""
    return setup.configured("sensor", contrast=log_units)


def readout(setup: Setup, times: float) -> Setup:
    """Adds ON events in two sweeps of 9.16 ms around each exposure, ``times`` times the measured.

    They come row by row, 35.2 µs each, and more where it is bright.
    """
    rng = setup.random("readout")
    sensor = setup.config.sensor

    def wire(piece: Piece) -> Piece:
        parts = [piece.events]
        first = piece.begin_us // sensor.frame_us - 1
        for k in range(first, first + 4):
            exposed_us = k * sensor.frame_us
            sweeps_us = (exposed_us - SWEEP_US, exposed_us + sensor.exposure_us)
            parts += [_sweep(piece, begin_us, times, rng) for begin_us in sweeps_us]
        events = join_events(parts)
        return replace(piece, events=pick_events(events, np.argsort(events["t"], kind="stable")))

    return setup.plus(wires=wire)


def _sweep(
    piece: Piece, begin_us: float, times: float, rng: np.random.Generator
) -> NDArray[np.void]:
    """Returns the events of the rows that a sweep reads within a piece."""
    read_us = begin_us + ROW_US * np.arange(1, SENSOR_HEIGHT_PX + 1)
    rows = np.flatnonzero((read_us >= piece.begin_us) & (read_us < piece.end_us))
    mean = times * np.interp(piece.picture_dn[rows], READ_GREY_DN, READ_EVENTS)
    y, x = np.nonzero(rng.random(mean.shape) < mean)
    events = np.zeros(len(x), EVENT_DTYPE)
    events["t"], events["x"], events["y"], events["p"] = read_us[rows[y]], x, rows[y], True
    return events
