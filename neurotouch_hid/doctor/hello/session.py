"""The guided minutes: prompts that wait for the person, and what is measured in each."""

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.doctor.gel import Seen, examine_frames
from neurotouch_hid.doctor.gel_score import GelScore, score_gel
from neurotouch_hid.doctor.hello.dot_light import measure_dot_light
from neurotouch_hid.doctor.hello.led import N_FLASHES, LedMeter
from neurotouch_hid.doctor.hello.meter import (
    REST_US,
    MotionMeter,
    RestMeter,
    Stroke,
    StrokeFinder,
)
from neurotouch_hid.gel_making.plan import Plan
from neurotouch_hid.geometry import Rig, fit_rig
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, Frame, GelState, GestureKind, Step
from neurotouch_hid.source.view import MIDDLE_PX, View

LIGHT: Final = "light"
REST: Final = "rest"
LED: Final = "led"
ALL: Final = "everything"
"""A recording follows no prompts: all after its rest is measured together."""
_SETTLE_US: Final = 800_000
"""After a gesture, before rest counts."""
_LEAST_REST_S: Final = 0.5
"""With less, nobody knows where the dots were before the first touch."""
_N_FRAMES: Final = 10
_JUDGE_US: Final = 2_000_000
"""From one judgement of light and focus to the next."""


@dataclass(frozen=True, slots=True)
class Prompt:
    """One thing that the person is asked for.

    Attributes:
        key: its name in the file.
        request: what the person is asked.
        kind: the gesture that is asked for; None for none.
    """

    key: str
    request: str
    kind: GestureKind | None = None


PROMPTS: Final = (
    Prompt(
        LIGHT,
        "Light and focus. Take your hand off the gel. You hear what to change, if anything is "
        "wrong. When all is well, or as well as it gets, go on.",
    ),
    Prompt(REST, "Rest. Leave the gel alone. Five seconds are enough.", GestureKind.NONE),
    Prompt("push_right", "Push the gel to the right, as you sit, and let go.", GestureKind.PUSH),
    Prompt("push_left", "Push the gel to the left, and let go.", GestureKind.PUSH),
    Prompt("pinch", "Put two fingers on the gel, pinch them, and let go.", GestureKind.PINCH),
    Prompt("zoom", "Put two fingers on the gel, spread them, and let go.", GestureKind.ZOOM),
    Prompt(
        "twist_cw", "Twist the gel clockwise with two fingers, and let go.", GestureKind.TWIST_CW
    ),
    Prompt("twist_ccw", "Twist it the other way, and let go.", GestureKind.TWIST_CCW),
    Prompt("rest_after", "Rest once more. Leave the gel alone.", GestureKind.NONE),
)

LED_PROMPT: Final = Prompt(
    LED, f"Latency. Hold the LED close before the lens, until it has flashed {N_FLASHES} times."
)


@dataclass(frozen=True, slots=True)
class Span:
    """Sensor time in which the person was asked for something: a weak label.

    Attributes:
        prompt: the prompt.
        begin_us, end_us: from the prompt to the person's word that it is done.
        strokes: what was recognised meanwhile.
        is_skipped: the person could not, or would not.
    """

    prompt: Prompt
    begin_us: int
    end_us: int
    strokes: tuple[Stroke, ...]
    is_skipped: bool = False

    def as_json(self) -> dict[str, Any]:
        """Returns the same as plain values."""
        return {
            "prompt": self.prompt.key,
            "asked": None if self.prompt.kind is None else self.prompt.kind.label,
            "begin_us": self.begin_us,
            "end_us": self.end_us,
            "skipped": self.is_skipped,
            "recognised": [
                {"gesture": each.kind.label, "intensity_mm": round(each.gesture.intensity_mm, 2)}
                for each in self.strokes
            ],
        }


class Session:
    """Goes from prompt to prompt, and measures.

    Args:
        plan: the gel as it should be.
        source: the source's kind, in words.
        prompts: what the person is asked for.
        guided: a person follows the prompts; otherwise the first stroke ends the rest.
        led: an LED, for which the person is asked last.

    Attributes:
        spans: what is done.
        score: light and focus, as they were judged last; None before the first frames.
        gel: the gel as it was seen last.
        has_events: the source sends events.
        rig: where the gel was in the canonical picture at rest; None before.
        n_prompts: number of prompts.
        begin_us, end_us: sensor time so far; None before the first slice.
        n_lost: events that were lost during movements; judging a picture at rest may cost some.
    """

    def __init__(
        self,
        plan: Plan,
        source: str,
        prompts: Iterable[Prompt] = PROMPTS,
        *,
        guided: bool = True,
        led: LedMeter | None = None,
    ) -> None:
        self.spans: list[Span] = []
        self.score: GelScore | None = None
        self.gel = GelState(layout=plan.gel)
        self.has_events = False
        self.rig: Rig | None = None
        self.begin_us: int | None = None
        self.end_us = 0
        self.n_lost = 0
        self._plan, self._source, self._guided = plan, source, guided
        self._left = deque(prompts if guided else (PROMPTS[1], Prompt(ALL, "")))
        self._led = led
        if led is not None:
            self._left.append(LED_PROMPT)
        self.n_prompts = len(self._left)
        self._frames: deque[Frame] = deque(maxlen=_N_FRAMES)
        self._rest = RestMeter()
        self._motion = MotionMeter(plan.gel, self._rest)
        self._finder = StrokeFinder()
        self._strokes: list[Stroke] = []
        self._asked_us = self._judged_us = 0
        self._said = ""
        self._at_rest: Step | None = None
        self._view: View | None = None
        self._rest_px: NDArray[np.float32] | None = None

    @property
    def prompt(self) -> Prompt | None:
        """The present request; None when all is done."""
        return self._left[0] if self._left else None

    @property
    def missing(self) -> str:
        """A sentence about what the present prompt lacks; empty if nothing."""
        prompt = self.prompt
        if prompt is None or prompt.key == LIGHT:
            is_clear = prompt is None or self.gel.is_found or self._is_blind
            return "" if is_clear else "The gel is not found yet."
        if prompt.key == REST and 1e6 * self._rest.seconds < REST_US:
            return f"{self._rest.seconds:.0f} of 5 seconds so far."
        if prompt.key == LED and self._led is not None:
            n_seen = len(self._led.delays_s)
            return "" if self._led.is_done else f"{n_seen} of {N_FLASHES} flashes were seen."
        if prompt.kind is not GestureKind.NONE and not self._strokes:
            return "No movement was seen yet."
        if prompt.kind is not GestureKind.NONE and self._finder.quiet_us < _SETTLE_US:
            return "Let go first: how the gel comes back is measured, too."
        return ""

    def take(self, step: Step, view: View | None = None) -> str:
        """Measures a slice; returns what the person should hear, or an empty text.

        Args:
            step: the slice.
            view: the map from the pictures of a video camera to the frames.
        """
        packet = step.packet
        if self.begin_us is None:
            self.begin_us = self._asked_us = packet.t_begin_us
        self.end_us, self._view = packet.t_end_us, view
        if self.prompt is not LED_PROMPT:  # its light may hide the gel
            self.gel = step.gel
        self._frames += packet.frames
        self.has_events |= len(packet.events) > 0
        stroke = self._finder.take(step)
        prompt = self.prompt
        if prompt is None:
            return ""
        if not self._guided and prompt.key == REST and step.gesture.kind is not GestureKind.NONE:
            self._judge(self._rest.frames, view)
            self.next()
            return ""
        if prompt.key == LIGHT:
            return self._tell_light(view)
        if prompt.key == REST:
            return self._take_rest(step, view)
        if prompt.key == LED and self._led is not None:
            return self._led.take(packet)
        return self._take_movement(step, stroke)

    def next(self, *, is_skipped: bool = False) -> None:
        """Goes to the next prompt: the person has done this one, or skips it."""
        prompt = self._left.popleft()
        if prompt.key == REST and self._at_rest is not None and self._rest.seconds >= _LEAST_REST_S:
            self._motion.set_home(self._at_rest)
            self._note_place(self._at_rest)
        strokes = tuple(self._strokes)
        self.spans.append(Span(prompt, self._asked_us, self.end_us, strokes, is_skipped))
        self._begin()

    def restart(self) -> None:
        """Begins the present prompt again."""
        if self._led is not None:
            self._led.restart()
        if self.prompt is not None and self.prompt.key == REST:
            self._rest = RestMeter()
            self._motion = MotionMeter(self._plan.gel, self._rest)
        self._begin()

    def finish(self) -> None:
        """Closes the present prompt: the source has ended."""
        if self.prompt is not None and self.end_us > self._asked_us:
            self.next(is_skipped=self._guided and not self._strokes)

    @property
    def has_frames(self) -> bool:
        """True once the source has sent a frame."""
        return bool(self._frames)

    def list_figures(self) -> dict[str, float | None]:
        """Returns all that was measured; None for what was not, or cannot be."""
        gel = self.gel
        light = {} if self.score is None else self.score.figures
        return {
            **self._rest.list_figures(),
            **self._motion.list_figures(),
            **self._measure_place(),
            "px_per_mm": gel.px_per_mm,
            "rotation_deg": gel.rotation_deg,
            "blur_px": None if self._is_blind else gel.blur_px,  # of a frame drawn from events
            "flicker_hz": gel.flicker_hz,
            "contrast_dn": light.get("contrast"),
            "tremble_mm": light.get("noise_mm"),
            "dots_missing": float(len(gel.missing)) if gel.is_found else None,
            "lost_events": float(self.n_lost),
            **({} if self._led is None else self._led.list_figures()),
        }

    def _note_place(self, step: Step) -> None:
        """Notes where the dots are, before anything touches them."""
        self._rest_px = step.markers.rest_px.copy()
        self.rig = fit_rig(self._rest_px, self._plan.gel)

    def _measure_place(self) -> dict[str, float | None]:
        """Returns where the gel was, in a picture 260 px high, and how bright it was.

        The scale and the turn of a video camera are those of its own picture, which the canonical
        one no longer shows.
        """
        rig, picture = self.rig, self._rest.picture
        names = ("centre_x_px", "centre_y_px", "fitted_px_per_mm", "fitted_turn_deg")
        if rig is None:
            return dict.fromkeys((*names, "dot_dn", "ground_dn", "peak_dn"))
        dots = None
        if picture is not None and self._rest_px is not None:
            dots = measure_dot_light(picture, self._rest_px, rig.px_per_mm, self._plan.gel)
        place = _place_in_camera(rig, self._view)
        values = (*place.centre_px, place.px_per_mm, math.degrees(place.rotation_rad))
        return {
            **dict(zip(names, values, strict=True)),
            "dot_dn": None if dots is None else dots.dot_dn,
            "ground_dn": None if dots is None else dots.ground_dn,
            "peak_dn": None if dots is None else dots.peak_dn,
        }

    def _begin(self) -> None:
        self._strokes, self._asked_us, self._said = [], self.end_us, ""

    def _take_rest(self, step: Step, view: View | None) -> str:
        is_touched = step.gesture.kind is not GestureKind.NONE
        if is_touched and 0.0 < 1e6 * self._rest.seconds < REST_US:
            self.restart()
            return "The gel was touched, so the rest begins again."
        if self._is_settled(step):
            self._at_rest = step
        elif not self._is_blind or self._finder.quiet_us < _SETTLE_US:
            return ""
        before = self._rest.seconds
        self._rest.take(step.packet)
        if 1e6 * before < REST_US <= 1e6 * self._rest.seconds:
            self._judge(self._rest.frames, view)
            return "That is enough. Go on when you like."
        return ""

    def _take_movement(self, step: Step, stroke: Stroke | None) -> str:
        self.n_lost += step.packet.gap
        if self.rig is None and self._is_blind and self._is_settled(step):
            self._note_place(step)
        self._motion.take(step, self._finder.quiet_us)
        if stroke is None:
            return ""
        self._strokes.append(stroke)
        return (
            f"{stroke.kind.label.replace('_', ' ')}, {stroke.gesture.intensity_mm:.1f} millimetres"
        )

    @property
    def _is_blind(self) -> bool:
        """Events have come, but no frame: the first touch shows the gel, and noise needs none."""
        return self.has_events and not self.has_frames

    def _is_settled(self, step: Step) -> bool:
        """Returns whether the dots of a gel are followed, and nothing has touched it for long.

        The driver may be too late to follow the dots of a gel that it has found.
        """
        is_seen = step.gel.is_found and bool(np.isfinite(step.markers.rest_px).all())
        return is_seen and self._finder.quiet_us >= _SETTLE_US

    def _tell_light(self, view: View | None) -> str:
        """Judges light and focus now and then; returns the judgement if it has changed."""
        if self.end_us - self._judged_us < _JUDGE_US or not self._frames:
            return ""
        if self._finder.quiet_us < _SETTLE_US:  # a touched gel looks worse than it is
            return ""
        self._judged_us = self.end_us
        self._judge(self._frames, view)
        line = "" if self.score is None else self.score.advice
        if line == self._said:
            return ""
        self._said = line
        return line

    def _judge(self, newest: Iterable[Frame], view: View | None) -> None:
        frames = tuple(newest)
        if not frames:
            return
        seconds = 1e-6 * (frames[-1].t_us - frames[0].t_us)
        seen = Seen(self._source, seconds, 0, 0, frames, is_video=view is not None, view=view)
        state = examine_frames(frames, self._plan.gel).state
        self.score = score_gel(seen, state, self._plan, planned=False)


def _place_in_camera(rig: Rig, view: View | None) -> Rig:
    """Returns where the gel is in the camera's own picture, as if that were 260 px high."""
    if view is None:
        return rig
    points = view.to_sensor(rig.to_px(np.array([(0.0, 0.0), (1.0, 0.0)])))
    shrunk = SENSOR_HEIGHT_PX / view.height_px
    middle = np.array([view.width_px - 1, view.height_px - 1]) / 2.0
    centre = (points[0] - middle) * shrunk + MIDDLE_PX
    right = points[1] - points[0]
    if view.mirrored:  # all later stages see it flipped, so here is it flipped, too
        centre[0], right[0] = 2.0 * MIDDLE_PX[0] - centre[0], -right[0]
    return Rig(
        (float(centre[0]), float(centre[1])),
        float(np.hypot(*right)) * shrunk,
        math.atan2(right[1], right[0]),
    )
