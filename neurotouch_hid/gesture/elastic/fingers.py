"""Follows the fingers on the gel by fitting the displacements that they cause."""

import math
from dataclasses import astuple, dataclass, fields, replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL, Gel, Rig, find_median, place_square
from neurotouch_hid.gesture.elastic.kernels.arrays import MOST, N_SIDES, make_arrays
from neurotouch_hid.gesture.elastic.kernels.field import fill_responses, rim_window
from neurotouch_hid.gesture.elastic.kernels.follow import locate_shown
from neurotouch_hid.gesture.elastic.kernels.markers import measure_spread
from neurotouch_hid.gesture.elastic.kernels.search import CHECK_US
from neurotouch_hid.process.kernel_cache import bind

Floats = NDArray[np.float64]

SITE_MM: Final = 4.0
"""Distance of the sites where fingers are searched for."""

_PLACES: Final = ("standing_x_mm", "standing_y_mm", "before_x_mm", "before_y_mm")
_BUMP_MM: Final = 0.4  # if the rest position has moved farther, the place before no longer counts
_MIDDLE: Final = 0.4
_REACH_MM: Final = 8.0


@dataclass(frozen=True, slots=True)
class FingerConfig:
    """Settings of the search for fingers in the displacements of the markers.

    The largest motion is that of the finger that moves most, mm.

    Attributes:
        radius_mm: initial radius of a fingertip's contact patch.
        rim_width_mm: fingers are searched for no nearer to the rim than this.
        spacing_mm: least distance of two fingertips.
        fresh_mm: a new finger is searched for no nearer to a known one than this, because the known
            one may have been fitted to the middle of both.
        most: the number of fingers that are searched for, at most ``MOST``.
        noise_gain: the sum of squares that a finger must explain, in noise variances; it adds to
            that of ``field_gain``.
        field_gain: the sum of squares that a finger must explain, in squares of the largest motion;
            on the gel of the paper. It grows with the number of markers under a finger.
            For one finger, finite elements and the closed form differ by 0.2 (nine in ten). A
            second finger adds 0.7 where both push side by side, and 1.3 to 10 elsewhere. A value of
            0.3 finds still fingers more often, also those of a resting hand; a push beside that
            hand then passes for a pinch.
        hint: one more finger is tried where it explains this share of what ``field_gain`` requires,
            while the others keep what they do. Fitted with them it explains up to five times that.
        keep: the share of the required sum that a finger must go on explaining to be kept.
        model_error: rms difference of the gel and the closed form, as a share of the largest
            motion.
        outlier: residual that halves a marker's weight, in standard errors.
        most_unexplained: if the followed fingers leave more than this share of the field's squares,
            and more than the required sum of one finger, fingers are searched for from nothing.
        most_hidden: if markers without trust leave more than this share of the field's squares, and
            more than the required sum of one finger, all markers count in a search from nothing.
        still_share: a finger takes no part in the gesture if it moves less than this share of the
            largest motion. With 0, a finger that drags towards a still one makes a pinch. Beside a
            resting hand such a still finger only rests, so it needs a larger value.
        least_mm: a smaller motion is no finger.
        least_noise_mm: the least error of a tracked marker on one axis.
        sure: a search stops if less than this share of the required sum is left in the field. It
            stays below 1 because of rounding.
    """

    radius_mm: float = 6.5
    rim_width_mm: float = 4.5
    spacing_mm: float = 8.5
    fresh_mm: float = 5.0
    most: int = MOST
    noise_gain: float = 40.0
    field_gain: float = 0.45
    hint: float = 0.25
    keep: float = 0.6
    model_error: float = 0.05
    outlier: float = 8.0
    most_unexplained: float = 0.4
    most_hidden: float = 0.2
    still_share: float = 0.0
    least_mm: float = 0.2
    least_noise_mm: float = 0.06
    sure: float = 0.999


CONFIG: Final = np.dtype(
    [(f.name, "i8" if f.name == "most" else "f8") for f in fields(FingerConfig)]
)
"""``FingerConfig`` as a record for kernels."""


class Contacts(NamedTuple):
    """The contacts that are shown.

    Attributes:
        mm: (k, 2) float64, gel coordinates, columns x, y.
        px: (k, 2) float64, the same points in the image.
        intensity_mm: how far they move the gel under them, their mean.
    """

    mm: Floats
    px: Floats
    intensity_mm: float


class FingerTracker:
    """Follows up to three fingers from slice to slice.

    Attributes:
        arrays: what the kernels share.
    """

    def __init__(self, config: FingerConfig | None = None, gel: Gel = PAPER_GEL) -> None:
        self.config = config or FingerConfig()
        density = _measure_density(gel) / _measure_density(PAPER_GEL)
        rules = replace(self.config, field_gain=density * self.config.field_gain)
        middle_mm, sides = find_sides(gel)
        sites = place_square(SITE_MM, min(gel.rim_mm - self.config.rim_width_mm, gel.radius_mm))
        sites = sites[((sites - middle_mm) @ sides[:, :2].T <= sides[:, 2]).all(axis=1)]
        is_between = (sites % (2.0 * SITE_MM)).any(axis=1)  # every fourth covers the gel
        sites = sites[np.argsort(is_between, kind="stable")]
        self.arrays = make_arrays(gel.n_markers, sites, np.array([astuple(rules)], CONFIG))
        places = self.arrays.gel[0]
        places["n_coarse"] = np.count_nonzero(~is_between)
        places["middle"], places["sides"] = middle_mm, sides
        places["inner_mm"] = sides[:, 2].min()
        places["rim_mm"] = gel.rim_mm
        self._n, self._state = gel.n_markers, self.arrays.state
        self._locate_shown = bind(locate_shown, self.arrays)
        self._built: Floats = np.full(gel.points_mm.shape, np.inf)
        self._rest_px: NDArray[np.float32] | None = None
        self.reset()

    def reset(self) -> None:
        """Forgets all fingers, but not where the whole gel is."""
        places = {name: self._state[name].copy() for name in _PLACES}
        self.arrays.fits["count"] = 0
        self.arrays.fits["trust"] = 0.0
        self._state[0] = 0
        for name, place_mm in places.items():
            self._state[name] = place_mm
        self._state["unsearched_us"] = CHECK_US

    def measure_noise(self) -> float:
        """Returns the spread of the markers about their common motion on one axis, mm."""
        moved, weight = (self.arrays.markers[name][0, : self._n] for name in ("moved", "weight"))
        return float(measure_spread(moved, weight))

    def place(self, rest_px: NDArray[np.float32], rig: Rig) -> None:
        """Takes new positions of the markers at rest.

        Args:
            rest_px: (n, 2) float32 px.
            rig: fitted to them.
        """
        arrays, config = self.arrays, self.config
        arrays.gel["rig"] = (
            *rig.centre_px,
            rig.px_per_mm * math.cos(rig.rotation_rad),
            rig.px_per_mm * math.sin(rig.rotation_rad),
        )
        if self._rest_px is not None:  # where the whole gel is counts from the new rest position
            moved_px = rest_px - self._rest_px
            moved_px = moved_px[np.isfinite(moved_px).all(axis=1)]
            x_mm, y_mm = rig.vector_to_mm(find_median(moved_px))
            is_bumped = math.hypot(x_mm, y_mm) > _BUMP_MM
            for name, moved_mm in zip(_PLACES, (x_mm, y_mm, x_mm, y_mm), strict=True):
                self._state[name] = 0.0 if is_bumped else self._state[name] - moved_mm
        self._rest_px = rest_px
        points_mm = rig.to_mm(rest_px)
        markers = arrays.markers[0]
        markers["points"][:, : self._n] = points_mm.T
        rim_mm = float(arrays.gel["rim_mm"][0])
        squares = (points_mm**2).sum(axis=1)
        markers["window"][: self._n] = [rim_window(float(r2), rim_mm) for r2 in squares]
        if np.abs(points_mm - self._built).max() < 0.4:
            return
        self._built = points_mm
        atoms = np.empty(arrays.atoms.shape)
        fill_responses(points_mm, arrays.sites, config.radius_mm, rim_mm, atoms)
        arrays.atoms[:] = atoms
        rows = atoms.reshape(len(atoms), -1, 3)
        arrays.inverse[:] = np.linalg.inv(
            np.einsum("nsa,nsb->sab", rows, rows) + np.diag([1e-6, 1e-6, 1e-2])
        )

    def locate_shown(self, least: int = 1) -> Contacts:
        """Returns the contacts of the fingers found in the last slice.

        Args:
            least: the least number of contacts, even if the fingers hardly move.
        """
        return Contacts(*self._locate_shown(least))


def find_sides(gel: Gel) -> tuple[Floats, Floats]:
    """Returns the polygon around the dots in which a finger's middle can be.

    No dot shows where a finger is that is farther out.

    Returns:
        (2,) float64 mm, the middle of the dots; (N_SIDES, 3) float64, of each side the x and the y
        of its outward direction, and its distance from that middle, mm.
    """
    middle_mm = gel.points_mm.mean(axis=0)
    angle = 2.0 * np.pi * np.arange(N_SIDES) / N_SIDES
    ways = np.column_stack([np.cos(angle), np.sin(angle)])
    out_mm = ((gel.points_mm - middle_mm) @ ways.T).max(axis=0)
    return middle_mm, np.column_stack([ways, out_mm])


def _measure_density(gel: Gel) -> float:
    """Returns how many markers a finger in the middle of a gel moves, weighted by the square."""
    near = np.hypot(*(gel.points_mm - gel.points_mm.mean(axis=0)).T) <= _MIDDLE * gel.radius_mm
    away = np.hypot(*(gel.points_mm[near, None] - gel.points_mm).transpose(2, 0, 1))
    return float(np.exp(-((away / _REACH_MM) ** 2)).sum(axis=1).mean())
