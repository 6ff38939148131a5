"""Events that an event camera would send of a real gel's picture (half real)."""

import itertools
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import make_gel, place_grid
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket

FIRST, N_FRAMES = 56, 162  # the gel is at rest in the first one, and nearly in the last
FRAME_US = 40_000
SHRINK = 3.2  # from 32 px between dots to 10
AT_PX = (120, 90)  # where the small picture is on the sensor
ROWS, COLUMNS = 7, 9  # another column and another row are half out of the picture
_WHOLE_PX = (300.0, 15.0)  # the dots left of this and below it are whole
_MOST_PX = 10.0  # from where the flow takes a dot to its blob
GEL = make_gel(
    "gelsight-mini",
    place_grid(COLUMNS, ROWS, 4.0, 4.0),
    pitch_mm=4.0,
    radius_mm=24.0,
    light=False,
    dome_height_mm=0.0,
)


@dataclass(frozen=True, slots=True, eq=False)
class RealPicture:
    """Events of a real picture.

    Attributes:
        packets: slices of 10 ms without frames.
        dots_px: (frames, n, 2) px, where the dots are in each picture, on the sensor.
    """

    packets: list[EventPacket]
    dots_px: NDArray[np.float64]


@lru_cache(maxsize=2)
def read_pictures(path: Path) -> NDArray[np.uint8]:
    """Returns the first pictures of a clip, (n, 240, 320)."""
    clip = cv2.VideoCapture(str(path))
    pictures = [cv2.cvtColor(clip.read()[1], cv2.COLOR_BGR2GRAY) for _ in range(FIRST + N_FRAMES)]
    return np.array(pictures[FIRST:])


def find_dots(picture: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Returns the middles of the dark dots, (m, 2) px."""
    smooth = cv2.GaussianBlur(picture, (0, 0), 1.2).astype(np.float32)
    depth = np.maximum(cv2.GaussianBlur(smooth, (0, 0), 16.0) - smooth, 0.0)
    above = (depth > 0.4 * np.percentile(depth, 98)).astype(np.uint8)
    _, labels, stats, _ = cv2.connectedComponentsWithStats(above)
    y, x = np.mgrid[: picture.shape[0], : picture.shape[1]]
    total, sum_x, sum_y = (
        np.bincount(labels.ravel(), (depth * part).ravel()) for part in (1.0, x, y)
    )
    real = (stats[:, cv2.CC_STAT_AREA] > 20) & (np.arange(len(stats)) > 0)
    return np.column_stack([sum_x, sum_y])[real] / total[real, None]


def follow_dots(pictures: NDArray[np.uint8]) -> tuple[NDArray[np.float64], list]:
    """Returns the dots of each picture, (frames, n, 2) px, and the flow between pictures."""
    first = find_dots(pictures[0])
    first = first[(first[:, 0] < _WHOLE_PX[0]) & (first[:, 1] > _WHOLE_PX[1])]
    rows = np.split(first[np.argsort(first[:, 1])], ROWS)
    grid = np.concatenate([row[np.argsort(row[:, 0])] for row in rows])
    flow = cv2.DISOpticalFlow_create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
    dots, flows = [grid], []
    for before, now in itertools.pairwise(pictures):
        forth = flow.calc(before, now, None)
        flows.append(forth)
        x, y = np.rint(dots[-1]).astype(int).T.clip(0, [[319], [239]])
        there = dots[-1] + forth[y, x]
        seen = find_dots(now)
        apart = np.hypot(*(there[:, None] - seen).transpose(2, 0, 1))
        nearest = apart.argmin(axis=1)
        near = apart.min(axis=1) < _MOST_PX
        dots.append(np.where(near[:, None], seen[nearest], there))
    return np.array(dots), flows


def make_events(path: Path, noise_hz: float = 1.0, contrast: float = 1.0) -> RealPicture:
    """Returns what an event camera would have seen of the clip.

    Args:
        path: the clip.
        noise_hz: noise events per second and pixel.
        contrast: share of the picture's contrast, in logarithms of light.
    """
    import eventcv  # only where the tests have it

    pictures = read_pictures(path)
    dots_px, flows = follow_dots(pictures)
    y, x = np.mgrid[: pictures.shape[1], : pictures.shape[2]].astype(np.float32)
    size = (round(pictures.shape[2] / SHRINK), round(pictures.shape[1] / SHRINK))
    steps = FRAME_US // 1000
    shown = []
    for before, now, forth in zip(pictures[:-1], pictures[1:], flows, strict=True):
        for step in range(steps):
            u = step / steps
            parts = [
                cv2.remap(picture, x - share * forth[..., 0], y - share * forth[..., 1], 1)
                for picture, share in ((before, u), (now, u - 1.0))
            ]
            mixed = (1.0 - u) * parts[0] + u * parts[1]
            shown.append(cv2.resize(mixed.astype(np.float32), size, interpolation=cv2.INTER_AREA))
    movie = np.array(shown)
    if contrast != 1.0:
        light = np.log(np.maximum(movie, 1.0))
        movie = np.exp(light.mean() + contrast * (light - light.mean()))
    found = eventcv.simulate(
        np.rint(movie.clip(0, 255)).astype(np.uint8),
        fps=1000, seed=1, pos_thres=0.2, neg_thres=0.2, sigma_thres=0.03, cutoff_hz=300.0,
        leak_rate_hz=0.1, shot_noise_rate_hz=noise_hz, refractory_us=500,
    ).numpy()  # fmt: skip
    events = np.zeros(len(found), EVENT_DTYPE)
    events["x"], events["y"] = found[:, 0] + AT_PX[0], found[:, 1] + AT_PX[1]
    events["t"], events["p"] = found[:, 2], found[:, 3] > 0
    events = events[np.argsort(events["t"], kind="stable")]
    ends = range(10_000, (len(pictures) - 1) * FRAME_US + 1, 10_000)
    cuts = np.searchsorted(events["t"], [0, *ends])
    packets = [
        EventPacket(end - 10_000, end, events[a:b], (), 0)
        for end, a, b in zip(ends, cuts[:-1], cuts[1:], strict=True)
    ]
    return RealPicture(packets, (dots_px + 0.5) / SHRINK - 0.5 + AT_PX)
