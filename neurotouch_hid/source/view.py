"""Maps the picture of any sensor to the canonical picture that all later stages know.

The canonical picture has 346 x 260 pixels. The gel's centre is its middle, at 2.5 px/mm.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.source.kernels import view as kernels

MIDDLE_PX: Final = ((SENSOR_WIDTH_PX - 1) / 2.0, (SENSOR_HEIGHT_PX - 1) / 2.0)
"""The middle of the canonical picture, (x, y) px."""
_LARGEST_BOX_PX: Final = 64
_LEAST_STRETCH: Final = 0.05  # a lens term out of its range leaves at least this


@dataclass(frozen=True, slots=True)
class View:
    """The map from a sensor's picture to the canonical picture.

    A point is freed of the lens's distortion about the middle of the sensor's picture, then moved,
    scaled, turned and perhaps mirrored. The lens follows the division model: a distance ``r`` from
    the middle, in half diagonals of the picture, was ``r / (1 + lens r²)`` before the lens.

    Attributes:
        width_px, height_px: size of the sensor's picture.
        centre_px: the point (x, y) of the undistorted sensor picture that comes to the middle.
        scale: canonical pixels per sensor pixel.
        rotation_rad: turn of the canonical picture against the sensor's, clockwise positive.
        mirrored: the sensor's picture is flipped left to right after everything else.
        lens: the radial lens term; negative for a barrel, 0 for an ideal lens.
    """

    width_px: int
    height_px: int
    centre_px: tuple[float, float]
    scale: float
    rotation_rad: float = 0.0
    mirrored: bool = False
    lens: float = 0.0

    @property
    def is_straight(self) -> bool:
        """True if a sensor row comes to one canonical row, and a column to one column."""
        return self.lens == 0.0 and self.rotation_rad == 0.0

    def to_canonical(self, points_px: NDArray[np.floating]) -> NDArray[np.float64]:
        """Returns canonical points (n, 2) of sensor points (n, 2), px."""
        straight = self.undistort(points_px)
        points = (straight - self.centre_px) @ self._matrix().T
        if self.mirrored:
            points[:, 0] *= -1.0
        return points + MIDDLE_PX

    def to_sensor(self, points_px: NDArray[np.floating]) -> NDArray[np.float64]:
        """Returns sensor points (n, 2) of canonical points (n, 2), px."""
        points = np.asarray(points_px, np.float64) - MIDDLE_PX
        if self.mirrored:
            points[:, 0] *= -1.0
        straight = points @ self._matrix() / self.scale**2 + self.centre_px
        off = straight - self._axis_px()
        square = (off**2).sum(axis=1, keepdims=True) / self._unit_px2()
        root = np.sqrt(np.maximum(1.0 - 4.0 * self.lens * square, 0.0))
        bent: NDArray[np.float64] = self._axis_px() + off * (2.0 / (1.0 + root))
        return bent

    def measure_radii(self, points_px: NDArray[np.floating]) -> NDArray[np.float64]:
        """Returns how far sensor points (n, 2) are from the lens's axis, (n,), half diagonals."""
        off = np.asarray(points_px, np.float64) - self._axis_px()
        radii: NDArray[np.float64] = np.sqrt((off**2).sum(axis=1) / self._unit_px2())
        return radii

    def undistort(self, points_px: NDArray[np.floating]) -> NDArray[np.float64]:
        """Returns where an ideal lens would show sensor points (n, 2), px."""
        off = np.asarray(points_px, np.float64) - self._axis_px()
        square = (off**2).sum(axis=1, keepdims=True) / self._unit_px2()
        stretch = np.maximum(1.0 + self.lens * square, _LEAST_STRETCH)
        straight: NDArray[np.float64] = self._axis_px() + off / stretch
        return straight

    def _axis_px(self) -> NDArray[np.float64]:
        return np.array([(self.width_px - 1) / 2.0, (self.height_px - 1) / 2.0])

    def _unit_px2(self) -> float:
        return (self.width_px**2 + self.height_px**2) / 4.0

    def _matrix(self) -> NDArray[np.float64]:
        c, s = math.cos(self.rotation_rad), math.sin(self.rotation_rad)
        return self.scale * np.array([[c, -s], [s, c]])


def whole_view(width_px: int, height_px: int, *, mirrored: bool = False) -> View:
    """Returns the view that shows a sensor's whole picture, as large as it fits."""
    scale = min(SENSOR_WIDTH_PX / width_px, SENSOR_HEIGHT_PX / height_px)
    return View(
        width_px, height_px, ((width_px - 1) / 2, (height_px - 1) / 2), scale, mirrored=mirrored
    )


class ViewTable:
    """Makes canonical pictures of sensor pictures; all its memory is taken at the start.

    A larger picture is averaged over boxes first, so that no dot falls between two pixels. No box
    is larger than a canonical pixel, which would blur the dots. Points beyond the sensor's picture
    show its edge.

    Args:
        view: the map.
    """

    def __init__(self, view: View) -> None:
        self.view = view
        self._n = n = min(max(int(1.0 / view.scale), 1), _LARGEST_BOX_PX)
        width, height = view.width_px // n, view.height_px // n
        if width < 2 or height < 2:
            raise ValueError(f"a picture of {view.width_px}×{view.height_px} is too small")
        at_x, at_y = ((at - (n - 1) / 2.0) / n for at in _list_points(view))
        shape = (SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX)
        self._share = np.empty((2, *shape), np.uint16)
        left, self._share[0] = _split(at_x, width)
        top, self._share[1] = _split(at_y, height)
        # Only the rows and columns that the table reads are averaged.
        first, last = int(top.min()), int(top.max()) + 2
        begin, end = int(left.min()), int(left.max()) + 2
        self._part = np.s_[first * n : last * n, begin * n : end * n]
        self._at = np.empty(shape, np.int32)
        self._at[:] = (top - first) * (end - begin) + (left - begin)
        self._row = np.empty((end - begin) * n, np.uint16)
        self._boxed = np.empty((last - first, end - begin), np.uint8)
        self._pairs = np.empty((last - first, end - begin), np.uint16)
        self._ends = np.empty((2, SENSOR_WIDTH_PX), np.uint16)

    def draw(self, pixels: NDArray[np.uint8], out: NDArray[np.uint8]) -> None:
        """Writes the canonical picture of a sensor picture.

        Args:
            pixels: (h, w) uint8 of the view's size.
            out: (260, 346) uint8, written.
        """
        view = self.view
        if pixels.shape != (view.height_px, view.width_px):
            raise ValueError(f"a picture of {pixels.shape[1]}×{pixels.shape[0]}, not the view's")
        part = pixels[self._part]
        if self._n > 1:
            kernels.average_boxes(part, self._n, self._row, self._boxed)
            part = self._boxed
        kernels.interpolate(part, self._at, self._share, self._pairs, self._ends, out)


def _list_points(view: View) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns x and y of all canonical pixels on the sensor; both broadcast to (260, 346)."""
    x, y = np.arange(float(SENSOR_WIDTH_PX)), np.arange(float(SENSOR_HEIGHT_PX))
    if view.is_straight:  # a row and a column say it all
        row = view.to_sensor(np.stack([x, np.zeros_like(x)], axis=1))
        column = view.to_sensor(np.stack([np.zeros_like(y), y], axis=1))
        return row[:, 0], column[:, 1:]
    points = view.to_sensor(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))
    shape = (SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX)
    return points[:, 0].reshape(shape), points[:, 1].reshape(shape)


def _split(at: NDArray[np.float64], size: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the pixel before each point of a row of pixels, and the weight of the one after."""
    inside = np.clip(at, 0.0, size - 1.0)
    before = np.minimum(np.floor(inside), size - 2.0)
    return before, np.rint((inside - before) * kernels.ONE)
