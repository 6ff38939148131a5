"""The sentences about the gel: what the camera sees of it, and what to do."""

from collections.abc import Mapping
from functools import lru_cache
from itertools import groupby
from typing import Final, NamedTuple

import numpy as np

from neurotouch_hid.errors import GelNotFoundError
from neurotouch_hid.geometry import NOMINAL_PITCH_PX, PAPER_GEL, Gel
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, GelProblem, GelState
from neurotouch_hid.status import GelFacts

_MOST_NAMED: Final = 8
_GEL_FILES: Final = "--gel, NAME.gel.yaml beside a recording, or gel.yaml"
MOST_OFF: Final = 0.15
"""Share of the pitch by which a dot may be off its place."""

_MAINS_HZ: Final = ((95.0, 105.0), (115.0, 125.0))
"""Twice the frequency of the mains, in both parts of the world."""


@lru_cache(maxsize=4)
def _find_places(gel: Gel) -> dict[int, tuple[int, int]]:
    """Returns row from the top and number from the left of each marker."""
    x, y = np.round(gel.points_mm, 3).T
    rows = groupby(np.lexsort((x, y)).tolist(), key=lambda marker: float(y[marker]))
    return {
        marker: (row, number)
        for row, (_, markers) in enumerate(rows, 1)
        for number, marker in enumerate(markers, 1)
    }


class GelSentence(NamedTuple):
    """A sentence about the gel in the picture, and the fix.

    Attributes:
        head: ``found``, ``not found`` or ``lost``.
        why: the problem; empty without one.
        fix: the fix; empty without a problem.
    """

    head: str
    why: str
    fix: str

    @property
    def text(self) -> str:
        """Head and reason, for example ``not found: the picture is dark``."""
        return f"{self.head}: {self.why}" if self.why else self.head


_SENTENCES: Final[Mapping[GelProblem, tuple[str, str]]] = {
    GelProblem.NONE: ("", ""),
    GelProblem.WAITING: ("no picture yet", ""),
    GelProblem.NO_FRAMES: (
        "the camera sends no pictures, and events show {n_seen} of {n_markers} dots so far",
        "Push the gel once and let go. If the pictures stay away: neurotouch doctor",
    ),
    GelProblem.EVENTS_ONLY: (
        "the camera sends no pictures, so events alone show the dots, less exactly",
        "Unplug the camera and plug it in again. If it stays so: neurotouch doctor",
    ),
    GelProblem.DARK: ("the picture is dark", "Switch the LED ring on, and take the lens cap off."),
    GelProblem.BRIGHT: (
        "the picture is too bright",
        "Dim the light, or set a smaller 'exposure_us' in camera.yaml.",
    ),
    GelProblem.NO_DOTS: (
        "the picture shows no pattern of dots ({n_seen} bright spots)",
        "Point the camera at the dots, and remove what is between the lens and the gel.",
    ),
    GelProblem.BLURRED: (
        "the picture is out of focus: each dot is blurred by {blur_px:.1f} px",
        "Turn the lens until the dots are sharp.",
    ),
    GelProblem.SMALL: (
        "the gel is too small in the picture: {px_per_mm:.1f} px/mm",
        "Move the camera nearer, until the gel fills half of the picture's height ({usual}).",
    ),
    GelProblem.LARGE: (
        "the gel is too large in the picture: {px_per_mm:.1f} px/mm",
        "Move the camera away, until the whole gel is in the picture ({usual}).",
    ),
    GelProblem.OUTSIDE: (
        "a part of the gel is outside of the picture{side}",
        "Turn the camera until the whole gel is in the picture.",
    ),
    GelProblem.PATTERN: (
        "a pattern of more than {n_markers} dots goes on around them, so it may be no gel",
        "Point the camera at the gel alone. Has the gel more dots? Describe them in gel.yaml.",
    ),
    GelProblem.FAINT: (
        "most dots are missing, or hardly brighter than the gel",
        "Light the gel with the LED ring at full brightness, or paint the dots whiter.",
    ),
    GelProblem.MISSING: (
        "{n_missing} of {n_markers} dots are missing or too faint: {named}",
        "Clean the gel, light all of it, and paint these dots again.",
    ),
    GelProblem.GLINTS: (
        "{n_glints} reflections are as bright as dots",
        "Turn the lamp away that the gel reflects, or spread its light with paper.",
    ),
    GelProblem.IRREGULAR: (
        "single dots are off their places by {scatter_px:.1f} px",
        "Paint the dots again, {pitch_mm:g} mm apart. Each may be off by {off_mm:g} mm.",
    ),
    GelProblem.BENT: (
        "the pattern of dots is bent by {bend_px:.1f} px",
        "Mount the camera straight below the gel. Does something press on the gel? Take it off.",
    ),
    GelProblem.TOUCHED: ("the gel is touched", "Take everything off the gel for two seconds."),
    GelProblem.LEARNING: (
        "the gel is being learnt",
        "Leave the gel untouched and still for two seconds.",
    ),
    GelProblem.MOVED: (
        "it has moved by {moved_mm:.1f} mm, and gestures count from its new place",
        "Mount the gel and the camera firmly.",
    ),
    GelProblem.RESTS: (
        "something rests on the gel",
        "Take it off. If your hand has to rest there: neurotouch profile set user neutral resting",
    ),
    GelProblem.TOO_FAST: (
        "the hand is too fast for this camera, so fast gestures do not count",
        "Move more slowly, or use a camera with more frames per second.",
    ),
    GelProblem.FLICKER: (
        "the light flickers at {flicker_hz:.0f} Hz",
        "Run the LED ring at full brightness or from direct current: dimming makes it flicker.",
    ),
}
"""The sentence and the fix for each problem: the only place that has them."""

_WIDE: Final = (
    "the pattern of dots is bent too much to be found",
    "Use a lens with a smaller angle of view, or mount the camera straight below the gel.",
)
"""The sentence and the fix where even the bend cannot be measured."""

_MAINS_FIX: Final = "Switch off the lamp on the mains, or keep its light off the gel."


def explain_gel(gel: GelState) -> GelSentence:
    """Returns what the camera sees of the gel, and what to do."""
    head = "found" if gel.is_found else "lost" if gel.was_found else "not found"
    why, fix = _SENTENCES[gel.problem]
    if gel.problem is GelProblem.BENT and gel.bend_px is None:
        why, fix = _WIDE
    if gel.problem is GelProblem.FLICKER and _is_mains(gel.flicker_hz or 0.0):
        fix = _MAINS_FIX
    why = why.format(
        n_markers=gel.layout.n_markers,
        n_seen=gel.n_seen,
        n_missing=len(gel.missing),
        n_glints=gel.n_glints,
        named=name_dots(gel.missing, gel.layout),
        side=_find_side(gel),
        px_per_mm=gel.px_per_mm or 0.0,
        bend_px=gel.bend_px or 0.0,
        scatter_px=gel.scatter_px or 0.0,
        blur_px=gel.blur_px or 0.0,
        flicker_hz=gel.flicker_hz or 0.0,
        moved_mm=gel.moved_mm,
    )
    made = gel.layout
    fix = fix.format(
        usual=f"{NOMINAL_PITCH_PX / made.pitch_mm:.1f} px/mm",
        pitch_mm=round(made.pitch_mm, 2),
        off_mm=round(MOST_OFF * made.pitch_mm, 2),
    )
    return GelSentence(head, why, fix)


def require_gel(gel: GelState, source: str = "this source", *, is_told: bool = False) -> None:
    """Checks what is known of a gel at the end of a source.

    Args:
        gel: what is known.
        source: what a person calls the source.
        is_told: the source said where the gel is; for a recording its rig file does.

    Raises:
        GelNotFoundError: no frame has shown it.
    """
    if not gel.was_found and is_told:
        raise GelNotFoundError(
            f"No gel was found in {source} at the place that its rig says.",
            hint="The rig of a recording is NAME.rig.yaml beside it. Correct or remove that file: "
            "without it, the gel is searched for.",
        )
    if not gel.was_found:
        sentence, made = explain_gel(gel), gel.layout
        called, fix = "", sentence.fix
        if made is not PAPER_GEL:
            called = f" '{made.name}' of {made.n_markers} dots"
            fix += f" Is '{made.name}' another gel? It comes from {_GEL_FILES}."
        raise GelNotFoundError(
            f"No gel{called} was found in {source}: {sentence.why}.", hint=fix.strip() or None
        )


def name_dots(markers: tuple[int, ...], gel: Gel = PAPER_GEL) -> str:
    """Returns for example ``row 3: 2, 5; row 8: 1``, counted from the top and from the left."""
    rows: dict[int, list[str]] = {}
    for marker in markers[:_MOST_NAMED]:
        row, number = _find_places(gel)[marker]
        rows.setdefault(row, []).append(str(number))
    named = "; ".join(f"row {row}: {', '.join(numbers)}" for row, numbers in rows.items())
    left = len(markers) - _MOST_NAMED
    return f"{named} and {left} more" if left > 0 else named


def describe_missing(new: frozenset[int], missing: frozenset[int], gel: Gel) -> str:
    """Returns which dots are missing, for a person who is told of ``new`` ones for the first time.

    Args:
        new: the dots, as places in ``Gel.points_mm``.
        missing: all that are missing.
        gel: the gel.
    """
    named, n = name_dots(tuple(sorted(new)), gel), len(new)
    are = "is" if n == 1 else "are"
    if new == missing:
        head = f"{n} of {gel.n_markers} dots {are} not seen: {named}."
    else:
        more = "more dot" if n == 1 else "more dots"
        head = f"{n} {more} {are} not seen: {named}; {len(missing)} of {gel.n_markers} in all."
    return f"{head} Gestures count without them."


def report_gel(gel: GelState) -> GelFacts:
    """Returns the same as plain values, ready for JSON."""
    sentence = explain_gel(gel)
    return {
        "found": gel.is_found,
        "markers": gel.layout.n_markers,
        "problem": gel.problem.value,
        "text": sentence.text,
        "fix": sentence.fix,
        "seen": gel.n_seen,
        "missing": list(gel.missing),
        "named": name_dots(gel.missing, gel.layout),
        "missing_px": [list(place) for place in gel.missing_px],
        "px_per_mm": gel.px_per_mm,
        "rotation_deg": gel.rotation_deg,
        "bend_px": gel.bend_px,
        "scatter_px": gel.scatter_px,
        "blur_px": gel.blur_px,
        "flicker_hz": gel.flicker_hz,
        "glints": gel.n_glints,
        "moved_mm": gel.moved_mm,
    }


def _find_side(gel: GelState) -> str:
    """Returns on which side most of the missing markers are outside of the picture."""
    places = np.array(gel.missing_px).reshape(-1, 2)
    x, y = places.T
    beyond = {
        "on the left": (x < 0).sum(),
        "on the right": (x > SENSOR_WIDTH_PX - 1).sum(),
        "at the top": (y < 0).sum(),
        "at the bottom": (y > SENSOR_HEIGHT_PX - 1).sum(),
    }
    side = max(beyond, key=lambda name: int(beyond[name]))
    return f", {side}" if beyond[side] else ""


def _is_mains(hz: float) -> bool:
    return any(low <= hz <= high for low, high in _MAINS_HZ)
