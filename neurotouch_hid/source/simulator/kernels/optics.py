"""The compiled loops of the optics: markers to the picture on the sensor."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.process.kernel_cache import kernel

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Records = NDArray[np.void]

SKIN = 0.2  # of the light that a white marker lets through, the dark gel lets through this share
BRIGHTEST_DN = 298.0  # the photoreceptor's tables end at 300

POINT_DTYPE = np.dtype(
    [
        ("base", "<f4"),
        ("light", "<f4"),
        ("image", "<f4"),
        ("exposed", "<f4"),
        ("is_touched", "?"),
        ("is_active", "?"),
    ],
    align=True,
)
"""The picture at one pixel, in DN of an 8-bit frame: ``base`` without markers, ``light`` under a
white marker, ``image`` now, ``exposed`` sum of ``image - base`` over the ticks of the exposure,
``is_touched`` whether a marker is drawn here, ``is_active`` whether the event pixel's signal may
change."""

COUNTS_DTYPE = np.dtype(
    [("touched", "<i8"), ("active", "<i8"), ("events", "<i8"), ("lost", "<i8")], align=True
)
"""How far the lists of a sensor are filled: ``touched`` pixels with a marker, ``active`` pixels,
``events``; and ``lost`` events that found no room."""


class Picture(NamedTuple):
    """The picture on the sensor.

    Attributes:
        canvas: (260 * 346,) POINT_DTYPE.
        touched: (260 * 346,) uint32, the pixels where a marker is drawn.
        active: (260 * 346,) uint32, the pixels whose signal may change.
        profile: (m,) float32, brightness of a marker over its squared relative radius.
        profile_scale: entries of ``profile`` per unit of squared relative radius.
        counts: (1,) COUNTS_DTYPE.
    """

    canvas: Records
    touched: NDArray[np.uint32]
    active: NDArray[np.uint32]
    profile: Singles
    profile_scale: float
    counts: Records


@kernel(error_model="numpy")
def draw_markers(
    knots: Floats,
    u: float,
    picture: Picture,
) -> None:
    """Redraws all markers at share ``u`` of the way from the second to the third knot.

    The pixels where a marker was or is become active.

    Args:
        knots: (4, n, 6) float64, four equally spaced moments: x, y px, the quadratic form (xx, xy,
            yy) of the marker's outline in 1/px², brightness: 1 is white, more a reflection that is
            brighter than a marker, less than 0 a shadow that takes this share of the light.
        u: 0..1.
        picture: updated.
    """
    canvas, touched, active = picture.canvas, picture.touched, picture.active
    profile, profile_scale, counts = picture.profile, picture.profile_scale, picture.counts[0]
    n_active = counts["active"]
    for slot in range(counts["touched"]):
        pixel = touched[slot]
        point = canvas[pixel]
        point["image"] = point["base"]
        point["is_touched"] = False
        if not point["is_active"]:
            point["is_active"] = True
            active[n_active] = pixel
            n_active += 1
    n = 0
    u2, u3 = u * u, u * u * u
    w0, w1 = 0.5 * (-u3 + 2.0 * u2 - u), 0.5 * (3.0 * u3 - 5.0 * u2 + 2.0)
    w2, w3 = 0.5 * (-3.0 * u3 + 4.0 * u2 + u), 0.5 * (u3 - u2)
    last = len(profile) - 1
    reach2 = last / profile_scale
    for i in range(knots.shape[1]):
        gain = (1.0 - u) * knots[1, i, 5] + u * knots[2, i, 5]
        if gain == 0.0:
            continue
        x = w0 * knots[0, i, 0] + w1 * knots[1, i, 0] + w2 * knots[2, i, 0] + w3 * knots[3, i, 0]
        y = w0 * knots[0, i, 1] + w1 * knots[1, i, 1] + w2 * knots[2, i, 1] + w3 * knots[3, i, 1]
        xx = (1.0 - u) * knots[1, i, 2] + u * knots[2, i, 2]
        xy = (1.0 - u) * knots[1, i, 3] + u * knots[2, i, 3]
        yy = (1.0 - u) * knots[1, i, 4] + u * knots[2, i, 4]
        det = xx * yy - xy * xy
        half_x, half_y = math.sqrt(reach2 * yy / det), math.sqrt(reach2 * xx / det)
        top, bottom = max(0, math.ceil(y - half_y)), min(SENSOR_HEIGHT_PX - 1, int(y + half_y))
        left, right = max(0, math.ceil(x - half_x)), min(SENSOR_WIDTH_PX - 1, int(x + half_x))
        for row in range(top, bottom + 1):
            dy = row - y
            for col in range(left, right + 1):
                dx = col - x
                q = (xx * dx * dx + 2.0 * xy * dx * dy + yy * dy * dy) * profile_scale
                if q >= last:
                    continue
                k, pixel = np.uint32(q), np.uint32(row * SENSOR_WIDTH_PX + col)
                point = canvas[pixel]
                if not point["is_touched"]:
                    point["is_touched"] = True
                    touched[n] = pixel
                    n += 1
                    if not point["is_active"]:
                        point["is_active"] = True
                        active[n_active] = pixel
                        n_active += 1
                step = profile[k + np.uint32(1)] - profile[k]
                cover = gain * (profile[k] + (q - k) * step)
                if gain < 0.0:
                    point["image"] = point["image"] * max(1.0 + cover, 0.0)
                    continue
                white = max(point["light"], point["base"])
                point["image"] = min(
                    point["image"] + cover * (white - point["base"]), white * max(gain, 1.0)
                )
    counts["touched"], counts["active"] = n, n_active


class Lamps(NamedTuple):
    """The light of one knot interval, where it changes.

    Attributes:
        changes: whether it does; without, the rest is not looked at.
        gain: (t,) float64, share of the usual light at the end of each tick.
        leak: (t,) float64, light through the gel at the end of each tick, in white markers.
        reach: (260 * 346,) float32, share of that light that reaches each pixel.
        shade: (2, 260 * 346) float32, share of the light that reaches each pixel at both ends.
    """

    changes: bool
    gain: Floats
    leak: Floats
    reach: Singles
    shade: Singles


@kernel
def shine(picture: Picture, lamps: Lamps, tick: int, u: float) -> None:
    """Changes the light on a picture whose markers have just been drawn.

    Args:
        picture: updated.
        lamps: the light.
        tick: index of the tick within the knot interval.
        u: 0..1, where in the interval the tick ends.
    """
    gain, leak = lamps.gain[tick], lamps.leak[tick]
    for i in range(len(picture.canvas)):
        point = picture.canvas[i]
        usual = point["image"] if point["is_touched"] else point["base"]
        shade = (1.0 - u) * lamps.shade[0, i] + u * lamps.shade[1, i]
        through = SKIN * point["light"] + (1.0 - SKIN) * (usual - point["base"])
        lit = usual * gain * shade + leak * lamps.reach[i] * through
        point["image"] = min(max(lit, 0.0), BRIGHTEST_DN)


@kernel
def expose(picture: Picture) -> None:
    """Adds the picture of one tick to the frame."""
    for slot in range(picture.counts[0]["touched"]):
        point = picture.canvas[picture.touched[slot]]
        point["exposed"] += point["image"] - point["base"]


@kernel
def expose_all(picture: Picture) -> None:
    """Adds the picture of one tick to the frame, in light that also changes between the markers."""
    for i in range(len(picture.canvas)):
        point = picture.canvas[i]
        point["exposed"] += point["image"] - point["base"]


@kernel
def read_frame(
    canvas: Records,
    n_exposed: int,
    dark_dn2: float,
    electrons_per_dn: float,
    frame_gain: float,
    pattern: Floats,
    noise: Singles,
    out: NDArray[np.uint8],
) -> None:
    """Writes what the pixels read after an exposure, and begins the next one.

    Args:
        canvas: (n,) POINT_DTYPE; ``exposed`` is 0 afterwards.
        n_exposed: ticks of the exposure.
        dark_dn2: variance of the noise in the dark, DN².
        electrons_per_dn: electrons that make one DN, for the noise of light.
        frame_gain: of the whole picture.
        pattern: (2, n) float64, gain and offset in DN of each pixel.
        noise: (n,) float32, standard normal.
        out: (n,) uint8, written.
    """
    ticks, gain = np.float32(n_exposed), np.float32(frame_gain)
    dark, per_dn = np.float32(dark_dn2), np.float32(electrons_per_dn)
    for i in range(len(canvas)):
        point = canvas[i]
        mean = point["base"] + point["exposed"] / ticks
        point["exposed"] = 0.0
        sigma = np.sqrt(dark + mean / per_dn)
        seen = (mean * gain) * pattern[0, i] + pattern[1, i] + sigma * noise[i]
        out[i] = np.uint8(min(max(np.rint(seen), 0.0), 255.0))


@kernel
def average_rows(weights: Floats, ticks: Singles, first: int, out: Floats) -> None:
    """Writes the mean of each row of a frame over its own exposure.

    Args:
        weights: (rows, k) float64, the share of each tick in each row.
        ticks: (k, rows, columns) float32, the picture of each tick, in a circle.
        first: where the circle begins.
        out: (rows, columns) float64, written.
    """
    n = len(ticks)
    out[:] = 0.0
    for k in range(n):
        tick = ticks[(first + k) % n]
        for row in range(out.shape[0]):
            weight = weights[row, k]
            if weight != 0.0:
                for column in range(out.shape[1]):
                    out[row, column] += weight * tick[row, column]
