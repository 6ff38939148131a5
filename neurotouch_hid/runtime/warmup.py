"""Compiles, or loads from the cache, every kernel of the pipeline before a gamepad appears."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import NOMINAL_PX_PER_MM, PAPER_GEL, Gel, Rig
from neurotouch_hid.gesture import GestureConfig, GestureRecognizer
from neurotouch_hid.messages import (
    EVENT_DTYPE,
    SENSOR_HEIGHT_PX,
    SENSOR_WIDTH_PX,
    EventPacket,
    Frame,
    MarkerField,
)
from neurotouch_hid.runtime.pipeline import Pipeline

_RIG = Rig((SENSOR_WIDTH_PX / 2, SENSOR_HEIGHT_PX / 2), NOMINAL_PX_PER_MM)
_SLICE_US = 50_000  # so long that the noise of a gel at rest is measured in the second one
_EVENTLESS_US = 2_000_000  # so long that the tracker expects no more events


def warm_up(pipeline: Pipeline, gel: Gel = PAPER_GEL) -> None:
    """Takes a few drawn slices through ``pipeline``: gel at rest, then pushed to the right.

    Use a pipeline of its own for this and throw it away: it remembers what it saw.

    Args:
        pipeline: built for the gel.
        gel: the gel that is drawn.
    """
    still, pushed = _place_markers(gel)
    pipeline.advance(EventPacket(-_SLICE_US, 0, _spread(still, -_SLICE_US)))  # no frame yet
    for k, position_px in enumerate((still, still, pushed, pushed)):
        t_us = k * _SLICE_US
        frame = Frame(_draw(position_px), t_us, t_us + _SLICE_US // 2)
        events = _spread(position_px, t_us)
        pipeline.advance(EventPacket(t_us, t_us + _SLICE_US, events, (frame,)))
    frame = Frame(frame.pixels, _EVENTLESS_US, _EVENTLESS_US + _SLICE_US // 2)  # frames alone
    pipeline.advance(EventPacket(_EVENTLESS_US, _EVENTLESS_US + _SLICE_US, events[:0], (frame,)))
    pipeline.close()


def warm_up_gestures(config: GestureConfig, gel: Gel = PAPER_GEL) -> None:
    """Recognises a push in markers that are known; no event and no frame is needed for that.

    Args:
        config: of the recogniser.
        gel: the gel.
    """
    recognizer = GestureRecognizer(config, gel)
    still_px, pushed_px = (each.astype(np.float32) for each in _place_markers(gel))
    valid = np.ones(gel.n_markers, np.bool_)
    for k, position_px in enumerate((still_px, still_px, pushed_px, pushed_px)):
        recognizer.update(MarkerField(k * _SLICE_US, still_px, position_px, valid, gel))


def _place_markers(gel: Gel) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the markers of a gel at rest, and of one pushed to the right, px."""
    still = _RIG.to_px(gel.points_mm)
    pushed = still + np.exp(-((gel.points_mm / 12) ** 2).sum(1, keepdims=True)) * (10.0, 0.0)
    return still, pushed


def _draw(position_px: NDArray[np.float64]) -> NDArray[np.uint8]:
    y, x = np.mgrid[:SENSOR_HEIGHT_PX, :SENSOR_WIDTH_PX]
    picture = np.full(y.shape, 20.0)
    for cx, cy in position_px:
        near = np.s_[max(int(cy) - 4, 0) : int(cy) + 6, max(int(cx) - 4, 0) : int(cx) + 6]
        picture[near] += 180 * np.exp(-((x[near] - cx) ** 2 + (y[near] - cy) ** 2) / 2)
    return np.clip(picture, 0, 255).astype(np.uint8)


def _spread(position_px: NDArray[np.float64], t_us: int) -> NDArray[np.void]:
    events = np.zeros(len(position_px), EVENT_DTYPE)
    events["t"] = t_us + np.arange(len(events))
    events["x"], events["y"] = np.rint(position_px).T
    return events
