"""Draws the picture of a gel with its dots in boxes, and says where such pictures are saved."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.partial_file import write_whole
from neurotouch_hid.players import find_home

Colour = tuple[int, int, int]
"""Blue, green and red, 0 to 255."""

GREEN: Final[Colour] = (0, 200, 0)
YELLOW: Final[Colour] = (0, 220, 220)
RED: Final[Colour] = (0, 0, 255)
_SCALE: Final = 3
_HALF_PX: Final = 3.0


def find_picture(name: str) -> Path:
    """Returns the path of a saved picture in the person's cache folder; it need not exist.

    Raises:
        ProfileError: as ``find_home``.
    """
    cache = Path(os.environ.get("XDG_CACHE_HOME", ""))
    if not cache.is_absolute():
        cache = find_home() / ".cache"
    return cache / "neurotouch" / name


def save_picture(
    path: Path, pixels: NDArray[np.uint8], boxes_px: Mapping[Colour, ArrayLike]
) -> None:
    """Saves a picture as PNG, three times as large, with a box around each of some places.

    Args:
        path: the file; its folder is made.
        pixels: (h, w) uint8.
        boxes_px: (n, 2) px for each colour, in the order in which they are drawn.

    Raises:
        OSError: it cannot be written.
        NeuroTouchError: it cannot be encoded.
    """
    import cv2  # noqa: PLC0415  # it takes 100 ms to load

    picture = cv2.cvtColor(pixels, cv2.COLOR_GRAY2BGR)
    picture = cv2.resize(picture, None, fx=_SCALE, fy=_SCALE, interpolation=cv2.INTER_NEAREST)
    for colour, places_px in boxes_px.items():
        for x, y in np.asarray(places_px, np.float64).reshape(-1, 2):
            first, last = (
                (round(_SCALE * (x + d) + 1), round(_SCALE * (y + d) + 1))
                for d in (-_HALF_PX, _HALF_PX)
            )
            cv2.rectangle(picture, first, last, colour, 1)
    done, encoded = cv2.imencode(".png", picture)
    if not done:
        raise NeuroTouchError(f"The picture '{path}' could not be made.")
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, encoded.tobytes())
