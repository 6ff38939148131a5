"""The records and arrays that the kernels of the fingers share."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import MOST_MARKERS
from neurotouch_hid.vocabulary import GestureKind

Floats = NDArray[np.float64]

MOST: Final = 3
"""Fingers of a gesture [NT, "Creation of the Gesture Detection Dataset"]."""

N_SIDES: Final = 32
"""Sides of the polygon around the dots in which fingers are."""

NOW, WARM, TRIED, COLD, BEST, N_FITS = np.arange(6)
"""Places of fits: of the last slice; followed; with one finger more or less; of a search from
nothing; the best of that search. They are numpy's integers, for which numba compiles one kernel
instead of one for each."""

FIT: Final = np.dtype(
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
        ("cost", "f8"),
        ("largest_mm", "f8"),
    ],
    align=True,
)
"""Fingers that explain a field.

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
- ``cost``: the weighted sum of squares of what is not explained, mm²; infinite where no fit was
  possible.
- ``largest_mm``: the largest motion of a finger.
"""

SLICE: Final = np.dtype(
    [("noise_mm", "f8"), ("step_us", "i8"), ("forming", "?"), ("falling", "?")], align=True
)
"""The arguments of ``follow`` for one slice, beside the displacements.

- ``noise_mm``: error of a marker on one axis.
- ``step_us``: time since the previous slice.
- ``forming``: the gesture may still become another one; also search for fingers from nothing.
- ``falling``: the fingers leave the gel; then no finger is added.
"""

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
"""The common motion of the fingers.

- ``n_fingers``: the number of fingers that take part. If it is 0, only ``sway_mm`` has a meaning;
  all else is 0, and ``scale`` is 1.
- ``largest_mm``: the largest motion of a finger.
- ``peak_mm``: how far dots under a finger go at most, see ``measure_peak``.
- ``sway_mm``: how far the whole gel is from its recent mean.
- ``error_mm``: rms of the displacement that the fingers do not explain, one axis.
- ``is_lost``: the fingers explain too little of the field, and no search found better ones.
- ``x_mm``, ``y_mm``: translation of the fingers' mean position.
- ``rotation_rad``: rotation about the mean position, clockwise for the user positive.
- ``scale``: scaling about the mean position, 1 at rest.
- ``parts_mm``: the motion since the fingers landed that speaks for each GestureKind; NONE has 0.
"""

STATE: Final = np.dtype(
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
        ("since", "f8", (MOST, 3)),
    ],
    align=True,
)
"""What the kernels remember beside the fits.

- ``slice``, ``motion``: arguments and result of ``follow``.
- ``next_id``: the next free name of a finger.
- ``n_checks``: how often the number of fingers was checked since there are some.
- ``unchecked_us``, ``unsearched_us``: time since that, and since fingers were last searched for
  from nothing.
- ``n_searches``, ``n_asked``: how often they were searched for, and how often all sites were asked.
- ``noise_mm``: error of a marker on one axis.
- ``common_x_mm``, ``common_y_mm``: how far the whole gel had moved at the last search.
- ``standing_x_mm``, ``standing_y_mm``: the recent mean place of the whole gel.
- ``before_x_mm``, ``before_y_mm``: where the whole gel was before the fingers came.
- ``taken_along``: by how much the fingers take the whole gel along, a share of their motion;
  negative where it follows less than the closed form says.
- ``since``: motions of the fingers since they landed, as ``motions`` of a fit.
"""

RIG: Final = np.dtype([("x_px", "f8"), ("y_px", "f8"), ("along", "f8"), ("across", "f8")])
"""``Rig`` as a record for kernels.

- ``x_px``, ``y_px``: its centre.
- ``along``, ``across``: the x and the y part of a mm along the gel's x axis, px.
"""

GEL: Final = np.dtype(
    [
        ("rig", RIG),
        ("n_markers", "i8"),
        ("n_coarse", "i8"),
        ("middle", "f8", 2),
        ("sides", "f8", (N_SIDES, 3)),
        ("inner_mm", "f8"),
        ("rim_mm", "f8"),
    ],
    align=True,
)
"""A gel at rest.

- ``rig``: where it is in the image.
- ``n_markers``: how many there are.
- ``n_coarse``: how many sites, the first, cover the gel.
- ``middle``, ``sides``, ``inner_mm``: where fingers can be, see ``find_sides``; nearer to the
  middle than ``inner_mm`` they can be anywhere.
- ``rim_mm``: where the gel is clamped.
"""


MARKERS: Final = np.dtype(
    [
        ("points", "f8", (2, MOST_MARKERS)),
        ("window", "f8", MOST_MARKERS),
        ("moved", "f8", (MOST_MARKERS, 2)),
        ("weight", "f8", MOST_MARKERS),
        ("residual", "f8", (N_FITS, MOST_MARKERS, 2)),
    ],
    align=True,
)
"""The markers of a gel; it has the first ``n_markers``.

- ``points``, ``window``: at rest, mm, with ``rim_window`` there.
- ``moved``: displacement of each, mm.
- ``weight``: trust in each, 0..1.
- ``residual``: the part of each one's motion that each fit leaves, mm.
"""


class FingerArrays(NamedTuple):
    """The arrays that the kernels read and write.

    Their types do not depend on the gel, so all gels share the compiled kernels. Records cost a
    call less than arrays do, whose owners are counted.

    Attributes:
        state: (1,) ``STATE``.
        rules: (1,) ``CONFIG``.
        fits: (N_FITS,) ``FIT``; the fingers of the last slice are in ``NOW``.
        markers: (1,) ``MARKERS``.
        gel: (1,) ``GEL``.
        sites: (s, 2) float64 mm, where fingers are searched for.
        inverse: (s, 3, 3) float64, see ``measure_gains``.
        atoms: (2 n, 3 s) float32, see ``fill_responses``; half as much to read as float64.
    """

    state: NDArray[np.void]
    rules: NDArray[np.void]
    fits: NDArray[np.void]
    markers: NDArray[np.void]
    gel: NDArray[np.void]
    sites: Floats
    inverse: Floats
    atoms: NDArray[np.float32]


def make_arrays(n: int, sites: Floats, rules: NDArray[np.void]) -> FingerArrays:
    """Returns the arrays for n markers; what is not given is 0.

    Args:
        n: markers.
        sites: see ``FingerArrays``.
        rules: see ``FingerArrays``.

    Raises:
        ValueError: kernels would write beyond the records' places.
    """
    if n > MOST_MARKERS:
        raise ValueError(f"A gel has at most {MOST_MARKERS} markers, not {n}.")
    gel = np.zeros(1, GEL)
    gel["n_markers"] = n
    return FingerArrays(
        state=np.zeros(1, STATE),
        rules=rules,
        fits=np.zeros(N_FITS, FIT),
        markers=np.zeros(1, MARKERS),
        gel=gel,
        sites=sites,
        inverse=np.zeros((len(sites), 3, 3)),
        atoms=np.zeros((2 * n, 3 * len(sites)), np.float32),
    )
