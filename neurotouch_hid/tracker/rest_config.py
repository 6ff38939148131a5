"""Limits of the rest detection."""

from dataclasses import dataclass, field

from neurotouch_hid.tracker.blobs import BlobConfig
from neurotouch_hid.tracker.lattice import LatticeConfig
from neurotouch_hid.tracker.stillness import StillConfig


@dataclass(frozen=True, slots=True)
class RestConfig:
    """Limits within which the gel counts as at rest.

    Attributes:
        max_chamfer_px2: largest Chamfer distance to the reference, 2.5 [NT, "Experiments"]. Only
            the sum of the two mean squared distances gives that number a meaning. Without other
            limits it counts a push of 1.6 mm as rest.
        max_apart_px2: a pixel that is farther from its nearest one counts as this, because a dot
            that has come or gone has not moved. Differs: the paper has no such limit.
        max_displacement_mm: largest distance of a seen marker from its reference, for all but
            ``max_displaced``. People label a gesture from about 0.3 mm on. Differs: the paper has
            no such limit (``math.inf`` gives the paper's detector: F1 0.86 on our simulation;
            0.3 mm gives 0.99).
        max_displaced: number of markers that may be farther off. Half of the eight markers under a
            fingertip are more; those at its edge move less than the finger. With 5 % of all markers
            instead, F1 is 0.976.
        min_share: least share of the reference's markers that must be seen at their places.
        still: when a gel is still. Then the mean of its frames, which are at least ``PACE_US``
            apart, becomes the reference even if it is bent more than an undeformed gel (odd
            optics). It becomes the new reference if it is elsewhere and bent no more than the old
            one (its mount was bumped, or a hand was on it at the start).
        max_odd_bend_px: largest bend with odd optics, as much as one finger that pushes by 1.5 mm.
        max_print_px: largest tolerance of single markers of a printed gel, standard deviation. It
            hides a light touch, so a gel painted by hand is accepted only once it has been still.
        max_odd_displaced: largest number of displaced markers of a still gel that is not bent, for
            example with reflections of light on the markers.
    """

    max_chamfer_px2: float = 2.5
    max_apart_px2: int = 9
    max_displacement_mm: float = 0.3
    max_displaced: int = 3
    min_share: float = 0.9
    max_odd_bend_px: float = 1.5
    max_print_px: float = 0.5
    max_odd_displaced: int = 25
    still: StillConfig = field(default_factory=StillConfig)
    blobs: BlobConfig = field(default_factory=BlobConfig)
    lattice: LatticeConfig = field(default_factory=LatticeConfig)
