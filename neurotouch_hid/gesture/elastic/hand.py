"""The fingers on the gel, followed from slice to slice by fitting the field they cause."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import LATTICE_MM
from neurotouch_hid.gesture.elastic.field.kernels import (
    fill_responses,
    measure_gains,
    rim_window,
)
from neurotouch_hid.gesture.elastic.fingers import Fingers
from neurotouch_hid.gesture.elastic.fit.kernels import refine

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class HandConfig:
    """How fingers are found in the field.

    Attributes:
        radius_mm: of a fingertip's contact patch, to begin with.
        reach_mm: no finger's middle is further from the gel's centre.
        spacing_mm: two fingertips cannot be nearer.
        fresh_mm: a new finger is looked for no nearer to a known one, which may have been fitted
            to the middle of both.
        most: fingers of a gesture [NT, "Creation of the Gesture Detection Dataset"].
        noise_gain: sum of squares, in noise variances, that a finger must explain.
        field_gain: the same, in squares of the largest motion. For one finger, finite elements and
            the closed form differ by 0.2 (nine in ten); a second finger brings 0.7 where both push
            side by side and 1.3 to 10 elsewhere.
        keep: share of the above that a finger must go on explaining.
        model_error: rms difference of the gel and the closed form, share of the largest motion.
        outlier: residual of a marker, in standard errors, that halves its weight.
        most_unexplained: share of the field's squares; where the followed fingers leave more, and
            more than one finger must explain, they are looked for anew.
        least_mm: a motion below this is no finger yet.
        least_noise_mm: the least error of a tracked marker, one axis.
    """

    radius_mm: float = 6.5
    reach_mm: float = 26.5
    spacing_mm: float = 8.5
    fresh_mm: float = 5.0
    most: int = 3
    noise_gain: float = 40.0
    field_gain: float = 0.6
    keep: float = 0.6
    model_error: float = 0.05
    outlier: float = 8.0
    most_unexplained: float = 0.4
    least_mm: float = 0.2
    least_noise_mm: float = 0.06


class Hand:
    """Follows up to three fingers; keeps where each one stuck to the gel."""

    def __init__(self, config: HandConfig | None = None) -> None:
        self.config = config or HandConfig()
        far = np.hypot(*LATTICE_MM.T) <= self.config.reach_mm
        self._sites = np.ascontiguousarray(LATTICE_MM[far])
        self._points: Floats = np.zeros((0, 2))
        self._built: Floats = np.full(LATTICE_MM.shape, np.inf)
        self.reset()

    def reset(self) -> None:
        """Forget all fingers."""
        self.fit: Fingers | None = None
        self.ids: tuple[int, ...] = ()
        self._trust = np.zeros(0)
        self._next_id = 0
        self._turn = 0

    def place(self, points_mm: Floats) -> None:
        """Take new positions (177, 2) mm of the markers at rest."""
        self._points = points_mm
        self._window = np.array([rim_window(float(r2)) for r2 in (points_mm**2).sum(axis=1)])
        if np.abs(points_mm - self._built).max() < 0.4:
            return
        self._built = points_mm
        count = len(self._sites)
        self._atoms = np.empty((count * 3, len(points_mm) * 2))
        fill_responses(points_mm, self._sites, self.config.radius_mm, self._atoms)
        rows = self._atoms.reshape(count, 3, -1)
        self._inverse = np.linalg.inv(
            np.einsum("san,sbn->sab", rows, rows) + np.diag([1e-6, 1e-6, 1e-2])
        )

    def update(self, moved_mm: Floats, weight: Floats, noise_mm: float, *, forming: bool) -> None:
        """Fit the fingers to the displacements of one slice.

        Args:
            moved_mm: (177, 2) mm.
            weight: (177,), 0 for markers that were not measured.
            noise_mm: error of a marker, one axis.
            forming: the gesture has just begun: look at everything afresh.
        """
        noise_mm = max(noise_mm, self.config.least_noise_mm)
        weight = weight * self._doubt(noise_mm)
        warm = self.fit
        if warm is not None:
            warm = self._refine(warm, moved_mm, weight, noise_mm, 1)
            if self._is_lost(warm, moved_mm, weight, noise_mm):
                warm = None
        if warm is not None:
            warm = self._extend(warm, moved_mm, weight, noise_mm)
            warm = self._reduce(warm, moved_mm, weight, noise_mm)
        self._turn += 1
        if warm is None or (forming and self._turn % 2 == 0):  # in turn with ``_reduce``
            cold = self._search(moved_mm, weight, noise_mm)
            if warm is None or (
                cold is not None and self._judge(cold, noise_mm) < 0.9 * self._judge(warm, noise_mm)
            ):
                warm = cold
        self._adopt(warm)

    def _is_lost(self, fit: Fingers, moved: Floats, weight: Floats, noise: float) -> bool:
        """True if the fingers followed so far have run into each other or explain too little."""
        error = 2.0 * float(weight.sum()) * noise**2
        field = float((weight * (moved**2).sum(axis=1)).sum()) - error
        most = max(self.config.most_unexplained * field, self._price(fit.largest_mm, noise))
        return not (self._apart(fit) and fit.cost - error < most)

    def _doubt(self, noise_mm: float) -> Floats | float:
        """Trust in each marker, (177,): one that was far off the last fit lost its dot."""
        if self.fit is None:
            return 1.0
        error2 = noise_mm**2 + (self.config.model_error * self.fit.largest_mm) ** 2
        far2: Floats = (self.fit.residual**2).sum(axis=1) / (self.config.outlier**2 * error2)
        return 1.0 / (1.0 + far2**2)

    def _adopt(self, fit: Fingers | None) -> None:
        """Take a fit; fingers keep the names of those that were near."""
        if fit is None:
            self.fit, self.ids, self._trust = None, (), np.zeros(0)
            return
        ids, trust = [], []
        old = self.fit
        free = list(range(len(self.ids)))
        for centre in fit.centres:
            near = None
            if old is not None and free:
                near = min(free, key=lambda k: float(np.hypot(*(old.centres[k] - centre))))
                if np.hypot(*(old.centres[near] - centre)) > self.config.spacing_mm:
                    near = None
            if near is None:
                ids.append(self._next_id)
                trust.append(0.0)
                self._next_id += 1
            else:
                free.remove(near)
                ids.append(self.ids[near])
                trust.append(min(0.98 * float(self._trust[near]) + 0.25, 12.0))
        self.fit, self.ids, self._trust = fit, tuple(ids), np.array(trust)

    def _price(self, largest_mm: float, noise_mm: float) -> float:
        """What a finger must explain to be believed, mm²."""
        config = self.config
        return config.noise_gain * noise_mm**2 + config.field_gain * largest_mm**2

    def _judge(self, fit: Fingers, noise_mm: float) -> float:
        return fit.cost + len(fit.centres) * self._price(fit.largest_mm, noise_mm)

    def _refine(
        self, fit: Fingers, moved: Floats, weight: Floats, noise: float, n_steps: int
    ) -> Fingers:
        new = Fingers(
            fit.centres.copy(),
            fit.radii.copy(),
            fit.motions.copy(),
            fit.press.copy(),
            np.zeros(3),
            np.zeros_like(moved),
        )
        trust = self._trust
        if len(trust) != len(fit.centres):
            trust = np.zeros(len(fit.centres))
            trust[: len(self._trust)] = self._trust[: len(trust)]
        new.cost = refine(
            self._points,
            self._window,
            moved,
            weight,
            new.centres,
            new.radii,
            self.config.radius_mm,
            trust,
            new.motions,
            new.press,
            new.offset,
            new.residual,
            noise,
            self.config.model_error,
            n_steps,
        )
        return new

    def _gains(self, residual: Floats, weight: Floats, fit: Fingers | None) -> Floats:
        gain = np.empty(len(self._sites))
        measure_gains(self._atoms, self._inverse, residual, weight, gain)
        if fit is not None:
            apart = np.hypot(*(self._sites[:, None] - fit.centres).transpose(2, 0, 1)).min(axis=1)
            gain[apart < self.config.fresh_mm] = 0.0
        return gain

    def _extend(self, fit: Fingers, moved: Floats, weight: Floats, noise: float) -> Fingers:
        """The fit with one finger more, if the field asks for it."""
        if len(fit.centres) >= self.config.most:
            return fit
        gain = self._gains(fit.residual, weight, fit)
        site = int(gain.argmax())
        price = self._price(fit.largest_mm, noise)
        if gain[site] < 0.4 * price:
            return fit
        more = self._add(fit, site, moved, weight, noise)
        return more if fit.cost - more.cost > price and self._apart(more) else fit

    def _reduce(self, fit: Fingers, moved: Floats, weight: Floats, noise: float) -> Fingers:
        """The fit without the finger whose turn it is, if the field can do without it.

        It is asked every second slice, which tells soon enough and costs half.
        """
        count = len(fit.centres)
        if count < 2 or self._turn % 2:
            return fit
        keep = np.arange(count) != self._turn // 2 % count
        less = Fingers(
            fit.centres[keep],
            fit.radii[keep],
            fit.motions[keep],
            fit.press[keep],
            fit.offset,
            fit.residual,
        )
        less = self._refine(less, moved, weight, noise, 2)
        price = self._price(fit.largest_mm, noise)
        return less if less.cost - fit.cost < self.config.keep * price else fit

    def _add(self, fit: Fingers, site: int, moved: Floats, weight: Floats, noise: float) -> Fingers:
        more = Fingers(
            np.vstack([fit.centres, self._sites[site]]),
            np.append(fit.radii, self.config.radius_mm),
            np.vstack([fit.motions, np.zeros(3)]),
            np.append(fit.press, 0.0),
            fit.offset,
            fit.residual,
        )
        more = self._refine(more, moved, weight, noise, 0)
        return self._refine(more, moved, weight, noise, 3)

    def _apart(self, fit: Fingers) -> bool:
        c = fit.centres
        return all(
            np.hypot(*(c[i] - c[j])) > 0.85 * self.config.spacing_mm
            for i in range(len(c))
            for j in range(i)
        )

    def _search(self, moved: Floats, weight: Floats, noise: float) -> Fingers | None:
        """Fingers found from nothing, the strongest first."""
        nobody = Fingers(
            np.zeros((0, 2)), np.zeros(0), np.zeros((0, 3)), np.zeros(0), np.zeros(3), moved
        )
        common = np.median(moved[weight > 0], axis=0)
        gain = self._gains(moved - common, weight, None)
        site = int(gain.argmax())
        if gain[site] < self.config.noise_gain * noise**2:
            return None
        fit = self._add(nobody, site, moved, weight, noise)
        if fit.largest_mm < self.config.least_mm:
            return None
        best = fit
        while len(fit.centres) < self.config.most:
            gain = self._gains(fit.residual, weight, fit)
            site = int(gain.argmax())
            if gain[site] < 0.3 * self._price(fit.largest_mm, noise):
                break
            fit = self._add(fit, site, moved, weight, noise)
            if self._apart(fit) and self._judge(fit, noise) < self._judge(best, noise):
                best = fit
        return best
