"""Gives the map from an event camera's picture to the canonical one, by where it sees the gel.

A camera without frames cannot show where the gel is before it is touched. So its place is written
in ``camera.yaml``; without, the whole picture is shown, and the tracker finds the gel in it by the
first touch. A finder of the place by events would make its ``View`` here.
"""

import math

from neurotouch_hid.geometry import Gel
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.source.events.config import EventsConfig
from neurotouch_hid.source.events.models import Model, Region
from neurotouch_hid.source.rig_file import describe_strobe
from neurotouch_hid.source.video.view_search import find_scale
from neurotouch_hid.source.view import View, whole_view


def place_gel(model: Model, config: EventsConfig, gel: Gel) -> View:
    """Returns the map from a camera's picture to the canonical one.

    Args:
        model: of the camera.
        config: the person's settings.
        gel: the gel.
    """
    whole = whole_view(model.width_px, model.height_px, mirrored=config.mirrored)
    scale = whole.scale if config.px_per_mm is None else find_scale(gel) / config.px_per_mm
    centre_px = config.centre_px or whole.centre_px
    return View(model.width_px, model.height_px, centre_px, scale, mirrored=config.mirrored)


def describe_place(config: EventsConfig) -> bytes:
    """Returns the rig file of a recording in the camera's own pixels; empty if there is none."""
    lines = ["mirrored: true"] if config.mirrored else []
    if config.px_per_mm is not None and config.centre_px is not None:
        lines += [f"centre_px: [{config.centre_px[0]:g}, {config.centre_px[1]:g}]"]
        lines += [f"px_per_mm: {config.px_per_mm:g}"]
    if config.strobe is not None:
        lines += [describe_strobe(config.strobe)]
    return "".join(f"{line}\n" for line in lines).encode()


def find_region(view: View) -> Region | None:
    """Returns the part of the sensor's picture that is shown; None for all of it."""
    half_width, half_height = (side / (2.0 * view.scale) for side in _SIDES)
    x, y = view.centre_px
    region = Region(
        max(0, math.floor(x - half_width)),
        max(0, math.floor(y - half_height)),
        min(view.width_px, math.ceil(x + half_width) + 1),
        min(view.height_px, math.ceil(y + half_height) + 1),
    )
    return None if region == (0, 0, view.width_px, view.height_px) else region


_SIDES = (SENSOR_WIDTH_PX, SENSOR_HEIGHT_PX)
