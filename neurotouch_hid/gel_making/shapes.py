"""The few shapes of which all parts are made; ``manifold3d`` makes and joins them."""

import ctypes
import math
from collections.abc import Iterable, Sequence
from contextlib import suppress
from functools import lru_cache
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Final

import numpy as np

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.geometry import Floats

if TYPE_CHECKING:
    from manifold3d import Manifold

AROUND: Final = 144
"""Sides of a large circle: one of 45 mm is then true to 0.01 mm."""
_AROUND_SMALL: Final = 24
_FAR: Final = 1000.0
_NEEDS: Final = ("libpthread.so.0", "libdl.so.2", "libstdc++.so.6", "libm.so.6", "libgcc_s.so.1")
"""The libraries that manifold3d needs. Its wheels tell the loader to look for them in a folder in
``/tmp``, which any user can make. What is loaded before is looked for nowhere."""


@lru_cache(maxsize=1)
def load_library() -> ModuleType:
    """Returns the module ``manifold3d``.

    Raises:
        NeuroTouchError: it is not installed.
    """
    try:
        for name in _NEEDS:
            with suppress(OSError):  # another processor or C library has others
                ctypes.CDLL(name)
        return import_module("manifold3d")
    except ImportError:
        raise NeuroTouchError(
            "Solids need manifold3d, which is not installed.",
            hint="Install it: pip install 'neurotouch-hid[gel]'. Without it, 'way: evening' in "
            "gel.yaml makes a flat gel.",
        ) from None


def turn(outline: Iterable[tuple[float, float]]) -> "Manifold":
    """Returns the solid that an outline of (r, z) makes when it turns about the axis."""
    library = load_library()
    points = np.array(list(outline), np.float64)
    x, y = points.T
    if float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) < 0.0:  # clockwise
        points = points[::-1]
    return library.Manifold.revolve(library.CrossSection([points]), AROUND)


def make_pipe(inner: float, outer: float, low: float, high: float) -> "Manifold":
    """Returns a pipe between two heights; a disc if ``inner`` is 0."""
    return turn([(inner, low), (outer, low), (outer, high), (inner, high)])


def make_rod(
    radius: float, low: float, high: float, at: Sequence[float] = (0.0, 0.0), top: float = -1.0
) -> "Manifold":
    """Returns an upright rod, or a cone with another radius at its top."""
    rod = load_library().Manifold.cylinder(high - low, radius, top, _AROUND_SMALL)
    return rod.translate((at[0], at[1], low))


def make_box(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]) -> "Manifold":
    """Returns a box between two places on each axis."""
    size = (x[1] - x[0], y[1] - y[0], z[1] - z[0])
    return load_library().Manifold.cube(size).translate((x[0], y[0], z[0]))


def make_opening(width: float, low: float, high: float, far: float = _FAR) -> "Manifold":
    """Returns an opening towards x with a roof of 45°, which needs no support.

    Args:
        width: along y.
        low: height of its floor.
        high: height of the ridge.
        far: how far it reaches along x, from the axis.
    """
    eaves = high - 0.5 * width
    outline = [
        (-0.5 * width, low),
        (0.5 * width, low),
        (0.5 * width, eaves),
        (0.0, high),
        (-0.5 * width, eaves),
    ]
    prism = load_library().CrossSection([np.array(outline)]).extrude(far)
    return prism.rotate((90.0, 0.0, 90.0))  # (across, up, along) becomes (y, z, x)


def spin(shape: "Manifold", degrees: Iterable[float]) -> "Manifold":
    """Returns copies of a shape, turned about the axis."""
    return join(shape.rotate((0.0, 0.0, each)) for each in degrees)


def join(shapes: "Iterable[Manifold]") -> "Manifold":
    """Returns the union of shapes."""
    library = load_library()
    return library.Manifold.batch_boolean(list(shapes), library.OpType.Add)


def place_around(radius: float, n: int, first_deg: float = 0.0) -> Floats:
    """Returns n points on a circle, (n, 2)."""
    angle = np.radians(first_deg) + 2.0 * math.pi * np.arange(n) / n
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def spread(n: int, first_deg: float = 0.0) -> list[float]:
    """Returns n directions in degrees, evenly around the axis."""
    return [first_deg + 360.0 * k / n for k in range(n)]
