"""Finds a mirrored or turned picture from one push to the right and one clockwise twist."""

import math
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from neurotouch_hid.client import is_served, is_service_running
from neurotouch_hid.doctor.finding import Finding, approve, skip, warn
from neurotouch_hid.driver.camera_settings import (
    FILE,
    CameraSettings,
    find_camera_file,
    load_camera_config,
)
from neurotouch_hid.driver.last_gel import LastGel
from neurotouch_hid.errors import NotRunningError
from neurotouch_hid.gel_sentences import explain_gel
from neurotouch_hid.geometry import PAPER_GEL, Gel, count_turns
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import EventPacket, GelProblem, Gesture, GestureKind, Step
from neurotouch_hid.players import find_machine_folder, find_runtime_folder
from neurotouch_hid.profile import load_profile
from neurotouch_hid.profile.reading import load_settings
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source import Source, open_source
from neurotouch_hid.source.davis import find_cameras
from neurotouch_hid.tracker import GelFinder
from neurotouch_hid.vocabulary import RUNNING_DRIVER, SourceKind, find_source_kind

_LEAST_MM: Final = 2.5
"""A weaker gesture has no clear direction."""
_MOST_OFF: Final = 1.0 / 3.0
"""Of the angle between two turns that look the same. A push that is farther from each of them has
to be made again."""
_PUSH: Final = "Push the gel to the right, as you sit, and let go. There is no time limit. {skip}"
_TWIST: Final = "Now twist the gel clockwise with two fingers, and let go. {skip}"
_SKIP: Final = "S and Enter skips."


@dataclass(frozen=True, slots=True)
class View:
    """The view of the camera on the gel, as two gestures show it.

    Attributes:
        is_mirrored: the picture has to be mirrored, or must not be mirrored any more.
        turned_deg: from the turn that was assumed to the true one, clockwise, of those that look
            the same: quarters of a square lattice.
        rotation_deg: true turn of the gel in the picture, after the mirroring has been corrected.
    """

    is_mirrored: bool
    turned_deg: int
    rotation_deg: float

    @property
    def is_right(self) -> bool:
        """Nothing needs to be changed."""
        return not self.is_mirrored and self.turned_deg == 0


def find_view(push: Gesture, twist: Gesture, rotation_deg: float, n_turns: int = 4) -> View | None:
    """Returns how the camera sees the gel; None if the direction of the push is not clear.

    Args:
        push: a push to the right, as it is seen.
        twist: a clockwise twist, as it is seen.
        rotation_deg: turn of the gel in the picture that was assumed.
        n_turns: turns after which the gel looks the same, within a whole one.
    """
    x, y = push.translation_mm
    seen_deg = math.degrees(math.atan2(y, x))
    is_mirrored = twist.kind is GestureKind.TWIST_CCW
    if is_mirrored:  # left and right change places, and the turn its sense
        seen_deg, rotation_deg = 180.0 - seen_deg, -rotation_deg
    part_deg = 360.0 / n_turns
    turned_deg = part_deg * round(seen_deg / part_deg)
    if abs(seen_deg - turned_deg) > _MOST_OFF * part_deg:
        return None
    true_deg = rotation_deg + turned_deg
    return View(is_mirrored, round(turned_deg) % 360, (true_deg + 180.0) % 360.0 - 180.0)


def watch_view(
    packets: Iterable[EventPacket],
    say: Callable[[str], object],
    is_skipped: Callable[[], bool],
    near_rad: float = 0.0,
    gel: Gel = PAPER_GEL,
) -> View | None:
    """Asks for the two gestures and returns how the camera sees the gel.

    Args:
        packets: from a live source.
        say: shows the person a sentence.
        is_skipped: tells whether the person wants to skip; called for every packet.
        near_rad: turn of the gel in the picture that is expected.
        gel: the gel.

    Returns:
        None if the person has skipped, or the source has ended.
    """
    pipeline = Pipeline.build(load_profile("default"), GestureConfig(), near_rad=near_rad, gel=gel)
    steps = _advance(pipeline, packets, say, is_skipped)
    view = None
    while view is None:
        say(_PUSH.format(skip=_SKIP))
        push = _wait_for(steps, {GestureKind.PUSH}, say)
        if push is None:
            return None
        say(_TWIST.format(skip=_SKIP))
        twist = _wait_for(steps, {GestureKind.TWIST_CW, GestureKind.TWIST_CCW}, say)
        if twist is None:
            return None
        view = find_view(push, twist, pipeline.gel.rotation_deg or 0.0, count_turns(gel))
        if view is None:
            say("The push went between two directions.")
    return view


@dataclass(frozen=True, slots=True)
class Advice:
    """The changes of the camera's settings that a view needs.

    Attributes:
        path: the file.
        changes: the values, by their keys; empty if nothing needs to be changed.
        is_own: this person may change the file; that of a service belongs to the machine.
    """

    path: Path
    changes: dict[str, bool | int]
    is_own: bool


def judge_view(view: View, advice: Advice) -> Finding:
    """Returns the finding about a view."""
    if view.is_right:
        return approve("A push to the right and a clockwise twist are seen as they are.")
    faults = ["mirrored"] if view.is_mirrored else []
    if view.turned_deg:
        faults.append(f"turned by {view.turned_deg}°")
    lines = ", ".join(f"{key}: {str(value).lower()}" for key, value in advice.changes.items())
    return warn(
        f"The camera sees the gel {' and '.join(faults)}.",
        f"Write into {advice.path}, and start the driver again: {lines}",
    )


def advise(view: View) -> Advice:
    """Returns what to change for a view, in the settings that the running driver reads."""
    is_own = is_served(find_runtime_folder()) or not is_service_running()
    path = find_camera_file() if is_own else find_machine_folder() / FILE
    changes: dict[str, bool | int] = {}
    if view.is_mirrored:
        changes["mirrored"] = not load_settings(path, CameraSettings).mirrored
    if not view.is_right:
        changes["rotation_deg"] = round(view.rotation_deg)
    return Advice(path, changes, is_own)


def try_directions(
    source: str | None,
    say: Callable[[str], object],
    is_skipped: Callable[[], bool],
    gel: Gel = PAPER_GEL,
) -> tuple[Finding, Advice | None]:
    """Asks for a push and a twist before a live source.

    Args:
        source: its name; None: what the running driver sees, or the first camera.
        say: shows the person a sentence.
        is_skipped: tells whether the person wants to skip.
        gel: the gel.
    """
    with ExitStack() as stack:
        opened = _open(stack, source, gel)
        if opened is None:
            return skip("It needs a camera, or a running driver. A recording shows no hand."), None
        view = watch_view(opened, say, is_skipped, LastGel().rotation_rad, gel)
    if view is None:
        return skip("You skipped the directions."), None
    advice = advise(view)
    return judge_view(view, advice), advice


def _open(stack: ExitStack, source: str | None, gel: Gel) -> Source | None:
    """Opens a live or simulated source; None without one."""
    if source is None:
        with suppress(NotRunningError):
            return stack.enter_context(open_source(RUNNING_DRIVER))
        if not any(not info.reason for info in find_cameras()):
            return None
        return stack.enter_context(open_source("davis:", camera=load_camera_config()))
    if find_source_kind(source) is SourceKind.RECORDING:
        return None
    return stack.enter_context(
        open_source(source, camera=load_camera_config(), gel=gel, finder=GelFinder(gel))
    )


def _advance(
    pipeline: Pipeline,
    packets: Iterable[EventPacket],
    say: Callable[[str], object],
    is_skipped: Callable[[], bool],
) -> Iterator[Step]:
    """Yields steps in which the gel is found, until the person skips."""
    told = None
    for packet in packets:
        if is_skipped():
            return
        if packet.is_partial:
            continue
        step = pipeline.advance(packet)
        state = step.gel.is_found, step.gel.problem
        is_news = state != told and step.gel.problem is not GelProblem.WAITING
        if not step.gel.is_found and is_news:
            seen = explain_gel(step.gel)
            say(f"The gel is {seen.text}. {seen.fix}".rstrip())
        told = state
        if step.gel.is_found:
            yield step


def _wait_for(
    steps: Iterator[Step], wanted: Collection[GestureKind], say: Callable[[str], object]
) -> Gesture | None:
    """Returns the strongest moment of the next gesture of a kind, once it has ended."""
    best: Gesture | None = None
    for step in steps:
        gesture = step.gesture
        if gesture.kind is not GestureKind.NONE:
            if best is None or gesture.intensity_mm > best.intensity_mm:
                best = gesture
            continue
        done, best = best, None
        if done is None or done.intensity_mm < _LEAST_MM:
            continue
        if done.kind in wanted:
            return done
        say(f"That was a {done.kind.label.partition('_')[0]}. Once more.")
    return None
