"""Follows the fingers on the gel by fitting the displacements that they cause."""

import math
from dataclasses import astuple, dataclass, fields, replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL, Gel, Rig, place_square
from neurotouch_hid.gesture.elastic.kernels.field import fill_responses, rim_window
from neurotouch_hid.gesture.elastic.kernels.follow import CHECK_US, N_FITS, follow, locate_shown
from neurotouch_hid.gesture.elastic.kernels.markers import measure_spread
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.process.kernel_cache import bind

Floats = NDArray[np.float64]

SITE_MM: Final = 4.0
"""Distance of the sites where fingers are searched for."""

N_SIDES: Final = 32
"""Sides of the polygon around the dots in which fingers are."""

_PLACES: Final = ("standing_x_mm", "standing_y_mm", "before_x_mm", "before_y_mm")
_BUMP_MM: Final = 0.4  # if the rest position has moved farther, the place before no longer counts
_MIDDLE: Final = 0.4
_REACH_MM: Final = 8.0

MOST: Final = 3
"""Fingers of a gesture [NT, "Creation of the Gesture Detection Dataset"]."""


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


def _lay_out_fit(n: int) -> np.dtype[np.void]:
    """Returns the dtype of fingers that explain one field of n markers.

    - ``count``: their number.
    - ``ids``: names that stay with them.
    - ``trust``: how surely earlier slices know their centres, 1/mm².
    - ``shown``: 1 for a finger that is shown as a contact, else 0.
    - ``landed``, ``landed_us``: how each finger landed, see ``subtract_landing``.
    - ``centres``, ``radii``: of the contact patches on the gel at rest, mm.
    - ``motions``: drag x, drag y in mm, sine of the turn; beyond the shear of the whole gel.
    - ``whole``: the same with that shear, so how far the fingers go.
    - ``press``: mm.
    - ``offset_x_mm``, ``offset_y_mm``, ``offset_rad``: motion of the whole gel.
    - ``aside_mm``: how far pressed gel flows aside where it flows farthest, of one finger.
    - ``residual``: the part of each marker's motion that is not explained, mm.
    - ``cost``: its weighted sum of squares, mm²; infinite where no fit was possible.
    - ``largest_mm``: the largest motion of a finger.
    """
    return np.dtype(
        [
            ("count", "i8"),
            ("ids", "i8", MOST),
            ("trust", "f8", MOST),
            ("shown", "i8", MOST),
            ("landed", "f8", (MOST, 3)),
            ("landed_us", "i8", MOST),
            ("centres", "f8", (MOST, 2)),
            ("radii", "f8", MOST),
            ("motions", "f8", (MOST, 3)),
            ("whole", "f8", (MOST, 3)),
            ("press", "f8", MOST),
            ("offset_x_mm", "f8"),
            ("offset_y_mm", "f8"),
            ("offset_rad", "f8"),
            ("aside_mm", "f8"),
            ("residual", "f8", (n, 2)),
            ("cost", "f8"),
            ("largest_mm", "f8"),
        ],
        align=True,
    )


SLICE: Final = np.dtype(
    [("noise_mm", "f8"), ("step_us", "i8"), ("forming", "?"), ("falling", "?")], align=True
)
"""The arguments of ``FingerTracker.update`` for one slice, beside the displacements."""

MOTION: Final = np.dtype(
    [
        ("n_fingers", "i8"),
        ("largest_mm", "f8"),
        ("peak_mm", "f8"),
        ("sway_mm", "f8"),
        ("error_mm", "f8"),
        ("is_lost", "?"),
        ("x_mm", "f8"),
        ("y_mm", "f8"),
        ("rotation_rad", "f8"),
        ("scale", "f8"),
        ("parts_mm", "f8", len(GestureKind)),
    ],
    align=True,
)
"""``FingerMotion`` as a record for kernels."""


def _lay_out_state(n: int) -> np.dtype[np.void]:
    """Returns the dtype of what the kernels remember of n markers beside the fits.

    - ``slice``, ``motion``: arguments and result of ``follow``.
    - ``next_id``: the next free name of a finger.
    - ``n_checks``: how often the number of fingers was checked since there are some.
    - ``unchecked_us``, ``unsearched_us``: time since that, and since fingers were last searched
      for from nothing.
    - ``n_searches``, ``n_asked``: how often they were searched for, and how often all sites were
      asked.
    - ``noise_mm``: error of a marker on one axis.
    - ``common_x_mm``, ``common_y_mm``: how far the whole gel had moved at the last search.
    - ``standing_x_mm``, ``standing_y_mm``: the recent mean place of the whole gel.
    - ``before_x_mm``, ``before_y_mm``: where the whole gel was before the fingers came.
    - ``taken_along``: by how much the fingers take the whole gel along, a share of their motion;
      negative where it follows less than the closed form says.
    - ``moved``: displacement of each marker, mm.
    - ``weight``: trust in each marker, 0..1.
    - ``since``: motions of the fingers since they landed, as ``motions`` of a fit.
    """
    return np.dtype(
        [
            ("slice", SLICE),
            ("motion", MOTION),
            ("next_id", "i8"),
            ("n_checks", "i8"),
            ("unchecked_us", "i8"),
            ("unsearched_us", "i8"),
            ("n_searches", "i8"),
            ("n_asked", "i8"),
            ("noise_mm", "f8"),
            ("common_x_mm", "f8"),
            ("common_y_mm", "f8"),
            ("standing_x_mm", "f8"),
            ("standing_y_mm", "f8"),
            ("before_x_mm", "f8"),
            ("before_y_mm", "f8"),
            ("taken_along", "f8"),
            ("moved", "f8", (n, 2)),
            ("weight", "f8", n),
            ("since", "f8", (MOST, 3)),
        ],
        align=True,
    )


RIG: Final = np.dtype([("x_px", "f8"), ("y_px", "f8"), ("along", "f8"), ("across", "f8")])
"""``Rig`` as a record for kernels.

- ``x_px``, ``y_px``: its centre.
- ``along``, ``across``: the x and the y part of a mm along the gel's x axis, px.
"""


class FingerMotion(NamedTuple):
    """The common motion of the fingers.

    Attributes:
        n_fingers: the number of fingers that take part. If it is 0, only ``sway_mm`` has a
            meaning; all else is 0, and ``scale`` is 1.
        largest_mm: the largest motion of a finger.
        peak_mm: how far dots under a finger go at most, see ``measure_peak``.
        sway_mm: how far the whole gel is from its recent mean.
        error_mm: rms of the displacement that the fingers do not explain, one axis.
        is_lost: the fingers explain too little of the field, and no search found better ones.
        x_mm: translation of the fingers' mean position along x.
        y_mm: the same along y.
        rotation_rad: rotation about the mean position, clockwise for the user positive.
        scale: scaling about the mean position, 1 at rest.
        parts_mm: (6,) float64, the motion since the fingers landed that speaks for each
            GestureKind; NONE has 0.
    """

    n_fingers: int
    largest_mm: float
    peak_mm: float
    sway_mm: float
    error_mm: float
    is_lost: bool
    x_mm: float
    y_mm: float
    rotation_rad: float
    scale: float
    parts_mm: Floats


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
        fits: (N_FITS,), see ``_lay_out_fit``; the fingers of the last slice are in ``NOW``.
        state: (1,), see ``_lay_out_state``.
        gel: (1,), the markers at rest, see ``_lay_out_gel``.
    """

    def __init__(self, config: FingerConfig | None = None, gel: Gel = PAPER_GEL) -> None:
        self.config = config or FingerConfig()
        self.fits = np.zeros(N_FITS, _lay_out_fit(gel.n_markers))
        density = _measure_density(gel) / _measure_density(PAPER_GEL)
        rules = replace(self.config, field_gain=density * self.config.field_gain)
        self._rules = np.array([astuple(rules)], CONFIG)
        self.state = np.zeros(1, _lay_out_state(gel.n_markers))
        self._slice, self._motion = self.state["slice"], self.state["motion"]
        middle_mm, sides = find_sides(gel)
        sites = place_square(SITE_MM, min(gel.rim_mm - self.config.rim_width_mm, gel.radius_mm))
        sites = sites[((sites - middle_mm) @ sides[:, :2].T <= sides[:, 2]).all(axis=1)]
        is_between = (sites % (2.0 * SITE_MM)).any(axis=1)
        self.gel = np.zeros(1, _lay_out_gel(gel.n_markers, len(sites)))
        self.gel["sites"] = sites[np.argsort(is_between, kind="stable")]
        self.gel["n_coarse"] = np.count_nonzero(~is_between)
        self.gel["middle"], self.gel["sides"] = middle_mm, sides
        self.gel["inner_mm"] = sides[:, 2].min()
        self.gel["rim_mm"] = gel.rim_mm
        records = self.state, self.fits, self.gel, self._rules
        self._follow, self._locate_shown = bind(follow, *records), bind(locate_shown, *records)
        self._built: Floats = np.full(gel.points_mm.shape, np.inf)
        self._rest_px: NDArray[np.float32] | None = None
        self.reset()

    def reset(self) -> None:
        """Forgets all fingers, but not where the whole gel is."""
        places = {name: self.state[name].copy() for name in _PLACES}
        self.fits["count"] = 0
        self.fits["trust"] = 0.0
        self.state[0] = 0
        for name, place_mm in places.items():
            self.state[name] = place_mm
        self.state["unsearched_us"] = CHECK_US

    def measure_noise(self) -> float:
        """Returns the spread of the markers about their common motion on one axis, mm."""
        return float(measure_spread(self.state["moved"][0], self.state["weight"][0]))

    def place(self, rest_px: NDArray[np.float32], rig: Rig) -> None:
        """Takes new positions of the markers at rest.

        Args:
            rest_px: (n, 2) float32 px.
            rig: fitted to them.
        """
        gel = self.gel[0]
        gel["rig"] = (
            *rig.centre_px,
            rig.px_per_mm * math.cos(rig.rotation_rad),
            rig.px_per_mm * math.sin(rig.rotation_rad),
        )
        if self._rest_px is not None:  # where the whole gel is counts from the new rest position
            x_mm, y_mm = rig.vector_to_mm(np.nanmedian(rest_px - self._rest_px, axis=0))
            is_bumped = math.hypot(x_mm, y_mm) > _BUMP_MM
            for name, moved_mm in zip(_PLACES, (x_mm, y_mm, x_mm, y_mm), strict=True):
                self.state[name] = 0.0 if is_bumped else self.state[name] - moved_mm
        self._rest_px = rest_px
        points_mm = rig.to_mm(rest_px)
        gel["points"] = points_mm.T
        rim_mm = float(gel["rim_mm"])
        gel["window"] = [rim_window(float(r2), rim_mm) for r2 in (points_mm**2).sum(axis=1)]
        if np.abs(points_mm - self._built).max() < 0.4:
            return
        self._built = points_mm
        count = len(gel["sites"])
        atoms = np.empty((len(points_mm) * 2, count * 3))
        fill_responses(points_mm, gel["sites"], self.config.radius_mm, rim_mm, atoms)
        gel["atoms"] = atoms
        rows = atoms.reshape(-1, count, 3)
        gel["inverse"] = np.linalg.inv(
            np.einsum("nsa,nsb->sab", rows, rows) + np.diag([1e-6, 1e-6, 1e-2])
        )

    def update(
        self,
        moved_px: Floats,
        use: NDArray[np.bool_],
        noise_mm: float,
        *,
        step_us: int = CHECK_US,
        forming: bool,
        falling: bool = False,
    ) -> FingerMotion:
        """Fits the fingers to the displacements of one slice.

        Args:
            moved_px: (n, 2) float64 px, displacement of each marker.
            use: (n,) bool, True for measured markers.
            noise_mm: error of a marker on one axis.
            step_us: time since the previous slice.
            forming: the gesture may still become another one; also search for fingers from nothing.
            falling: the fingers leave the gel; then no finger is added.

        Returns:
            Their common motion.
        """
        self._slice[0] = (noise_mm, step_us, forming, falling)
        self._follow(moved_px, use)
        return FingerMotion._make(self._motion.item())

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


def _lay_out_gel(n: int, n_sites: int) -> np.dtype[np.void]:
    """Returns the dtype of a gel of n markers at rest.

    - ``rig``: where it is in the image.
    - ``points``, ``window``: the markers, mm, with ``rim_window`` there.
    - ``sites``: where fingers are searched for, mm. The first ``n_coarse``, every fourth, cover
      the gel.
    - ``middle``, ``sides``, ``inner_mm``: where fingers can be, see ``find_sides``; nearer to the
      middle than ``inner_mm`` they can be anywhere.
    - ``rim_mm``: where the gel is clamped.
    - ``atoms``, ``inverse``: see ``fill_responses`` and ``measure_gains``. ``atoms`` are float32,
      half as much to read for each slice.
    """
    return np.dtype(
        [
            ("rig", RIG),
            ("points", "f8", (2, n)),
            ("window", "f8", n),
            ("sites", "f8", (n_sites, 2)),
            ("n_coarse", "i8"),
            ("middle", "f8", 2),
            ("sides", "f8", (N_SIDES, 3)),
            ("inner_mm", "f8"),
            ("rim_mm", "f8"),
            ("inverse", "f8", (n_sites, 3, 3)),
            ("atoms", "f4", (2 * n, 3 * n_sites)),
        ],
        align=True,
    )
