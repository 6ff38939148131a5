"""Draws pictures of a gel for any sensor, with a lens of another model than the view's."""

import numpy as np

from neurotouch_hid.geometry import PAPER_GEL, Rig


def place_dots(rig, size_px, rim=0.0, gel=PAPER_GEL, push_mm=0.0):
    """Where a lens shows the dots, (n, 2) px: ``rim`` is the change of scale at the gel's rim."""
    axis = (np.array(size_px) - 1) / 2
    near = np.exp(-((gel.points_mm - (10.0, 0.0)) ** 2).sum(axis=1, keepdims=True) / 100.0)
    off = rig.to_px(gel.points_mm + near * (push_mm, 0.0)) - axis
    reach = np.hypot(*(np.array(rig.centre_px) - axis)) + gel.radius_mm * rig.px_per_mm
    square = (off**2).sum(axis=1, keepdims=True) / reach**2
    return axis + off * (1 + rim * square)


def draw_gel(rig, size_px, rim=0.0, *, gel=PAPER_GEL, noise=2.0, room=False, push_mm=0.0, seed=0):
    """A picture (h, w) uint8 of a gel; ``room``: a bright, cluttered room around it."""
    width, height = size_px
    rng = np.random.default_rng(seed)
    dots = place_dots(rig, size_px, rim, gel, push_mm)
    picture = np.full((height, width), 20.0)
    if room:
        y, x = np.mgrid[:height, :width]
        picture += (
            60 + 40 * np.sin(x / 37) * np.cos(y / 23) + 30 * (rng.random(picture.shape) > 0.9)
        )
        disc = np.hypot(*(np.stack([x, y], axis=-1) - rig.centre_px).T).T
        picture[disc < (gel.radius_mm + 3) * rig.px_per_mm * (1 + max(rim, 0))] = 20
    sigma = 0.25 * rig.px_per_mm * gel.dot_mm
    reach = int(4 * sigma) + 2
    for cx, cy in dots:
        y0, x0 = max(int(cy) - reach, 0), max(int(cx) - reach, 0)
        part = picture[y0 : int(cy) + reach + 1, x0 : int(cx) + reach + 1]
        y, x = np.mgrid[y0 : y0 + part.shape[0], x0 : x0 + part.shape[1]]
        part += 180 * np.exp(-((x - cx) ** 2 + (y - cy) ** 2) / (2 * (sigma**2 + 0.3)))
    picture += rng.normal(0, noise, picture.shape)
    pixels = np.clip(picture, 0, 255).astype(np.uint8)
    return pixels if gel.light else 255 - pixels


def middle_rig(size_px, px_per_mm, rotation_rad=0.0, off_px=(0.0, 0.0)):
    """A rig with the gel in the middle of the picture, or ``off_px`` beside it."""
    centre = (np.array(size_px) - 1) / 2 + off_px
    return Rig((float(centre[0]), float(centre[1])), px_per_mm, rotation_rad)
