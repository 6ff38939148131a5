"""Scores a gel that a person has made: what a camera sees of it, against its file."""

import math
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.doctor.finding import CheckStatus, Finding, approve, fail, skip, warn
from neurotouch_hid.doctor.gel import (
    LEAST_CONTRAST,
    MOST_OFF_CENTRE_PX,
    Seen,
    measure_contrast,
)
from neurotouch_hid.doctor.glare import find_glare, name_sides
from neurotouch_hid.gel_making.plan import Plan
from neurotouch_hid.gel_sentences import MOST_OFF, explain_gel, name_dots
from neurotouch_hid.geometry import Rig, fit_rig
from neurotouch_hid.messages import (
    SENSOR_HEIGHT_PX,
    SENSOR_WIDTH_PX,
    Frame,
    GelProblem,
    GelState,
)
from neurotouch_hid.tracker import BlobFinder
from neurotouch_hid.tracker.diagnosis import measure_gel
from neurotouch_hid.tracker.lattice import Lattice, LatticeFinder
from neurotouch_hid.tracker.sharpness import is_blurred

_TROUBLES: Final = (CheckStatus.FAILED, CheckStatus.WARNING)
_LEAST_SHARE: Final = 0.9
"""Share of the dots that a good gel has; the recogniser plays with fewer."""
_MOST_OFF_SCALE: Final = 0.1
"""Share of the planned scale by which the scale may be off."""
_LEAST_FILL, _MOST_FILL = 0.4, 1.0
_USUAL_ERROR_MM: Final = 0.2
"""Error of the intensity on simulated gels, from 60 pictures/s or with events
(docs/research/notebook-recognition.md, "Against a DAVIS")."""
_LEAST_FPS: Final = 50.0
_MOST_ERROR_MM: Final = 0.5
_N_FRAMES: Final = 10


@dataclass(frozen=True, slots=True)
class GelScore:
    """The score of a gel.

    Attributes:
        figures: what was measured, ready for JSON; None for what is not known.
        findings: a judgement of each figure, with what to change.
    """

    figures: dict[str, Any]
    findings: tuple[Finding, ...]

    @property
    def line(self) -> str:
        """The most important figures in a line, and the first thing to change."""
        figures = self.figures
        if figures.get("dots_found") is None:
            parts = []
        else:
            parts = [
                f"{figures['dots_found']} of {figures['dots']} dots",
                f"blurred by {figures['blur_px']:.1f} px",
                f"{100 * figures['fill']:.0f} % of the height",
                f"contrast {figures['contrast']}",
            ]
        parts.append(self.advice or "all in order")
        return "; ".join(parts)

    @property
    def advice(self) -> str:
        """The first thing to change, after what is wrong; empty if all is in order."""
        trouble = next(
            (each for each in self.findings if each.status in _TROUBLES and each.fix), None
        )
        return "" if trouble is None else f"{trouble.sentence} {trouble.fix}"

    @property
    def is_good(self) -> bool:
        """True if nothing failed."""
        return all(each.status is not CheckStatus.FAILED for each in self.findings)

    def as_json(self) -> dict[str, Any]:
        """Returns the same as plain values."""
        return {"figures": self.figures, "findings": [each.as_json() for each in self.findings]}


def score_gel(seen: Seen | None, state: GelState | None, plan: Plan, *, planned: bool) -> GelScore:
    """Scores the gel that some frames show.

    Args:
        seen: the data of some seconds; None if the source could not be opened.
        state: what the rest detector says of them; None without frames.
        plan: the gel as its file describes it.
        planned: the file says which camera looks at it, so the scale can be compared.
    """
    if seen is None or state is None:
        finding = fail("There is no picture.", "Check the camera: neurotouch doctor")
        return GelScore({}, (replace(finding, check="gel"),))
    picture = _Picture(seen, state, plan)
    findings = picture.judge(planned=planned)
    return GelScore(picture.list_figures(), tuple(findings))


class _Picture:
    """The last picture of a gel, measured.

    Args:
        seen: the data.
        state: what the rest detector says of them.
        plan: the gel as it should be.
    """

    def __init__(self, seen: Seen, state: GelState, plan: Plan) -> None:
        self._seen, self._plan, self._gel = seen, plan, plan.gel
        frame = seen.frames[-1]
        blobs = BlobFinder(gel=self._gel)
        self._blobs = blobs.find(frame.pixels).copy()
        self._lattice = LatticeFinder(self._gel).find(self._blobs.centroid_px)
        self._state = state
        if self._lattice is not None:
            self._state = measure_gel(frame, self._blobs, self._lattice, self._gel)
        self._is_found = state.is_found or (
            self._lattice is not None and state.problem in _HARMLESS
        )
        self._problem = state.problem
        self._contrast = measure_contrast(self._gel.lighten(frame.pixels))
        self._noise_mm = self._measure_noise()
        self._fill, self._px_per_mm = self._measure_scale()

    def judge(self, *, planned: bool) -> list[Finding]:
        """Returns all findings, each with its name."""
        found = [  # causes before what they cause: a picture out of focus is faint, too
            ("gel", self._judge_gel()),
            ("focus", self._judge_focus()),
            ("scale", self._judge_scale(planned=planned)),
            ("middle", self._judge_middle()),
            ("dots", self._judge_dots()),
            ("places", self._judge_places()),
            ("contrast", self._judge_contrast()),
            ("glare", self._judge_glare()),
            ("intensity", self._judge_intensity()),
        ]
        return [replace(finding, check=name) for name, finding in found]

    def list_figures(self) -> dict[str, Any]:
        """Returns what was measured."""
        state, lattice = self._state, self._lattice
        return {
            "source": self._seen.source,
            "found": self._is_found,
            "dots": self._gel.n_markers,
            "dots_found": None if lattice is None else lattice.n_found,
            "missing": list(state.missing),
            "scatter_mm": None if lattice is None else round(self._to_mm(lattice.print_px), 2),
            "contrast": round(self._contrast),
            "glare": [] if lattice is None else self._find_glare(lattice),
            "px_per_mm": None if self._px_per_mm is None else round(self._px_per_mm, 2),
            "fill": None if self._fill is None else round(self._fill, 3),
            "blur_px": state.blur_px,
            "noise_mm": None if self._noise_mm is None else round(self._noise_mm, 3),
            "intensity_error_mm": None if lattice is None else round(self._expect_error(), 2),
            "fps": None if self._fps is None else round(self._fps, 1),
        }

    @property
    def _fps(self) -> float | None:
        return len(self._seen.frames) / self._seen.seconds if self._seen.seconds else None

    def _judge_gel(self) -> Finding:
        if self._is_found:
            return approve(f"The gel is found ({self._seen.source}).")
        why = explain_gel(replace(self._state, problem=self._problem))
        return fail(f"The gel is {why.text}.", why.fix)

    def _judge_dots(self) -> Finding:
        if self._lattice is None:
            return skip("The dots form no pattern of this gel.")
        n, missing = self._gel.n_markers, self._state.missing
        if not missing:
            return approve(f"{n} of {n} dots.")
        why = explain_gel(replace(self._state, problem=GelProblem.MISSING))
        many = len(missing) > (1.0 - _LEAST_SHARE) * n
        named = name_dots(missing, self._gel)
        sentence = f"{n - len(missing)} of {n} dots. Missing or too faint: {named}."
        return (fail if many else warn)(sentence, why.fix)

    def _judge_places(self) -> Finding:
        if self._lattice is None:
            return skip("Needs the pattern.")
        off_mm = self._to_mm(self._lattice.print_px)
        sentence = f"Dots are off their places by {off_mm:.2f} mm."
        if off_mm > 0.5 * MOST_OFF * self._gel.pitch_mm:
            why = explain_gel(replace(self._state, problem=GelProblem.IRREGULAR))
            return warn(sentence, why.fix)
        return approve(sentence)

    def _judge_contrast(self) -> Finding:
        sentence = f"Dots are {self._contrast:.0f} grey levels from the gel."
        if self._contrast < LEAST_CONTRAST:
            return warn(sentence, "More light on the gel, whiter dots, or a longer exposure.")
        return approve(sentence)

    def _judge_glare(self) -> Finding:
        if self._lattice is None:
            return skip("Needs the pattern.")
        glare = self._find_glare(self._lattice)
        if not glare:
            return approve("No glare among the dots.")
        return warn(
            f"Glare {', '.join(glare)}.",
            "Make the inner side of the skin dull, or cover the LEDs with white paper.",
        )

    def _judge_scale(self, *, planned: bool) -> Finding:
        fill, scale = self._fill, self._px_per_mm
        if fill is None or scale is None:
            return skip("Needs the pattern.")
        sentence = f"{scale:.1f} px/mm: the gel fills {100 * fill:.0f} % of the picture's height"
        wanted = self._plan.measure_fill()
        if planned and abs(fill / wanted - 1.0) > _MOST_OFF_SCALE:
            off_mm = self._plan.distance * (wanted / fill - 1.0)
            way = "nearer" if off_mm > 0.0 else "away"
            return warn(
                f"{sentence}, and its file says {100 * wanted:.0f} %.",
                f"Move the camera {abs(off_mm):.0f} mm {way}.",
            )
        if not planned and not _LEAST_FILL <= fill <= _MOST_FILL:
            way = "nearer" if fill < _LEAST_FILL else "away"
            return warn(f"{sentence}.", f"Move the camera {way}.")
        return approve(f"{sentence}.")

    def _judge_middle(self) -> Finding:
        if self._lattice is None:
            return skip("Needs the pattern.")
        if self._seen.view is not None:
            view = self._seen.view
            off = np.subtract(view.centre_px, ((view.width_px - 1) / 2, (view.height_px - 1) / 2))
            most = MOST_OFF_CENTRE_PX * view.height_px / SENSOR_HEIGHT_PX
        else:
            centre = self._fit().centre_px
            off = np.subtract(centre, ((SENSOR_WIDTH_PX - 1) / 2, (SENSOR_HEIGHT_PX - 1) / 2))
            most = MOST_OFF_CENTRE_PX
        sentence = f"The gel is {off[0]:+z.0f} px, {off[1]:+z.0f} px off the middle."
        if np.hypot(*off) > most:
            return warn(sentence, "Move the camera until the gel is in the middle of the picture.")
        return approve(sentence)

    def _judge_focus(self) -> Finding:
        blur_px, scale = self._state.blur_px, self._state.px_per_mm
        if blur_px is None or scale is None:
            return skip("Needs the pattern.")
        sentence = f"Each dot is blurred by {blur_px:.1f} px, {blur_px / scale:.2f} mm."
        if is_blurred(blur_px, scale):
            why = explain_gel(replace(self._state, problem=GelProblem.BLURRED))
            return warn(sentence, why.fix)
        return approve(sentence)

    def _judge_intensity(self) -> Finding:
        if self._lattice is None:
            return skip("Needs the pattern.")
        fps, error_mm = self._fps, self._expect_error()
        noise = (
            "" if self._noise_mm is None else f"; dots at rest tremble by {self._noise_mm:.3f} mm"
        )
        sentence = f"Expected error of the intensity: {error_mm:.2f} mm on simulated gels{noise}."
        if self._seen.is_video and fps is not None and fps < _LEAST_FPS:
            return warn(
                f"{sentence} It is larger in fast motion: {fps:.0f} pictures/s are few.",
                "Use a camera with 60 pictures/s or more.",
            )
        if error_mm > _MOST_ERROR_MM:
            return warn(
                sentence,
                "Was the gel touched? Then check again. If not: more light makes the dots "
                "steadier; so does a sharper picture.",
            )
        return approve(sentence)

    def _expect_error(self) -> float:
        """Returns the expected error of the intensity, mm: the usual one, and the noise."""
        return math.hypot(_USUAL_ERROR_MM, self._noise_mm or 0.0)

    def _fit(self) -> Rig:
        assert self._lattice is not None  # noqa: S101 - every caller has asked
        return fit_rig(self._lattice.position_px, self._gel)

    def _to_mm(self, px: float) -> float:
        return px / (self._state.px_per_mm or 1.0)

    def _measure_scale(self) -> tuple[float | None, float | None]:
        """Returns the share of the picture's height, and the scale in the camera's own pixels."""
        canonical = self._state.px_per_mm
        if canonical is None:
            return None, None
        view = self._seen.view
        scale = canonical if view is None else canonical / view.scale
        height = SENSOR_HEIGHT_PX if view is None else view.height_px
        return 2.0 * self._plan.radius * scale / height, scale

    def _measure_noise(self) -> float | None:
        """Returns how much dots tremble from frame to frame, mm, beyond a motion of all."""
        if self._lattice is None:
            return None
        frames = self._seen.frames[-_N_FRAMES:]
        places = [each for frame in frames if (each := self._find_places(frame)) is not None]
        if len(places) < 3:
            return None
        stack = np.stack(places)
        stack = stack - np.nanmedian(stack, axis=1, keepdims=True)
        seen = np.isfinite(stack).all(axis=(0, 2))
        if not seen.any():
            return None
        return self._to_mm(float(np.sqrt(stack[:, seen].var(axis=0).mean())))

    def _find_places(self, frame: Frame) -> NDArray[np.float64] | None:
        dots_px = BlobFinder(gel=self._gel).find(frame.pixels).centroid_px
        lattice = LatticeFinder(self._gel).find(dots_px)
        if lattice is None:
            return None
        places = np.full((self._gel.n_markers, 2), np.nan)
        known = lattice.blob >= 0
        places[known] = dots_px[lattice.blob[known]]
        return places

    def _find_glare(self, lattice: Lattice) -> list[str]:
        rig = self._fit()
        spots = find_glare(self._seen.frames[-1].pixels, self._blobs, lattice, self._gel)
        return name_sides(spots - rig.centre_px, self._plan.radius * rig.px_per_mm)


_HARMLESS: Final = (
    GelProblem.NONE,
    GelProblem.WAITING,
    GelProblem.LEARNING,
    GelProblem.BLURRED,
    GelProblem.FLICKER,
)
"""With one of these, a single picture that shows the dots is enough."""
