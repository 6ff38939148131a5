"""Status of a running driver, and the check that an answer is one."""

from typing import (
    Any,
    Literal,
    NotRequired,
    TypedDict,
    cast,
    get_args,
    get_origin,
    get_type_hints,
    is_typeddict,
)

from neurotouch_hid.errors import DriverError
from neurotouch_hid.vocabulary import PipelineState

StageSpread = TypedDict("StageSpread", {"p50": float, "p99": float, "p99.9": float})
"""Percentiles of the time in a stage since the start, in ms a slice."""


class Fatigue(TypedDict):
    """A movement that fades.

    Attributes:
        movement: its name, as in the person's ranges.
        peak_mm: how far it goes now.
        full_mm: what the range could be set to; None while it need not be.
        needs: the share of its range that it needs now; 1 without help.
    """

    movement: str
    peak_mm: float
    full_mm: float | None
    needs: float


class ErrorNote(TypedDict):
    """One error: a sentence, and its time in s since 1970."""

    at: float
    error: str


class GelFacts(TypedDict):
    """Facts about the gel as the camera sees it.

    Attributes:
        found: the places of the dots are known, so gestures count.
        markers: number of all dots of the gel.
        problem: the problem in a word; empty without one.
        text: ``found``, or the problem in a sentence.
        fix: the fix; empty without a problem.
        seen: dots seen at their places; all bright dots, if they form no lattice.
        missing: dots that are not seen, counted from 0, row by row from the top left.
        named: the same in words.
        missing_px: where they should be in the picture, [x, y] px.
        px_per_mm: scale of the picture; None if it is unknown, as are the next four.
        rotation_deg: turn of the gel in the picture, clockwise.
        bend_px: how far the dots are from a smooth lattice.
        scatter_px: how far single dots are off that lattice.
        blur_px: how blurred each dot is.
        flicker_hz: frequency at which the light flickers; None if it is steady.
        glints: bright spots among the dots that are none.
        moved_mm: how far the gel is from where it was found first.
    """

    found: bool
    markers: int
    problem: str
    text: str
    fix: str
    seen: int
    missing: list[int]
    named: str
    missing_px: list[list[float]]
    px_per_mm: float | None
    rotation_deg: float | None
    bend_px: float | None
    scatter_px: float | None
    blur_px: float | None
    flicker_hz: float | None
    glints: int
    moved_mm: float


class PipelineStatus(TypedDict):
    """Status of a running pipeline.

    Attributes:
        pid: the driver's process.
        state: whether gestures act.
        profile: name of the profile that is active.
        layer: name of its layer that is active.
        markers_tracked: how many of the gel's markers are measured.
        gel: the gel as the camera sees it.
        gesture: the gesture now, ``none`` at rest.
        ignored: the last gesture that had no effect, and why, in a sentence; None without.
        silent_s: for how long nothing has come from the source; 0 while it comes.
        uptime_s: since the start.
        slices: since the start.
        slices_hz: slices per second.
        events_hz: events per second.
        events_lost: since the start.
        stage_ms: mean host time a slice, by stage.
        stage_spread_ms: its percentiles since the start.
        fatigue: movements that fade.
        long_holds: how often each movement was held for more than 5 s.
        errors: the newest errors.
    """

    pid: int
    state: PipelineState
    profile: str
    layer: str
    markers_tracked: int
    gel: GelFacts
    gesture: str
    ignored: str | None
    silent_s: float
    uptime_s: float
    slices: int
    slices_hz: float
    events_hz: int
    events_lost: int
    stage_ms: dict[str, float]
    stage_spread_ms: dict[str, StageSpread]
    fatigue: list[Fatigue]
    long_holds: dict[str, int]
    errors: list[ErrorNote]


class RumbleState(TypedDict):
    """Strength with which a game shakes the pad, 0 to 1."""

    strong: float
    weak: float


class PadFacts(TypedDict):
    """Facts about a pad and the devices that play along.

    Attributes:
        copilot: the physical device that plays along.
        mouse: the mice that are watched.
        rumble: how games shake the pad.
    """

    copilot: str
    mouse: str
    rumble: RumbleState


class Described(PadFacts):
    """A sentence about each thing that surrounds the pipeline, and how a game shakes the pad.

    Attributes:
        source: the source, and why nothing comes from it.
        simulated: no sensor has seen the packets.
        device: the virtual gamepad.
        keyboard: the keyboards that can stop the driver.
        desktop: the window that has chosen the profile.
        sound: the way in which the driver is heard.
        settings: the owner of the settings that apply.
    """

    source: str
    simulated: bool
    device: str
    keyboard: str
    desktop: str
    sound: str
    settings: str


class Status(PipelineStatus, Described):
    """The answer to ``status``.

    Attributes:
        ok: True.
        version: of this format: 1.
    """

    ok: Literal[True]
    version: int


class Done(TypedDict):
    """The answer to a command that is carried out.

    Attributes:
        ok: True.
        text: a sentence for the person.
        done: whether it has taken effect already.
        profile: name of the profile that is active now, where one was loaded.
    """

    ok: Literal[True]
    text: str
    done: NotRequired[bool]
    profile: NotRequired[str]


class Recording(TypedDict):
    """The answer to ``record``; packets follow it.

    Attributes:
        ok: True.
        source: the source of the driver.
        simulated: no sensor has seen the packets.
        seed: of the simulation; None if the source has none.
        text: a sentence for the person.
    """

    ok: Literal[True]
    source: str
    simulated: bool
    seed: int | None
    text: str


class PlayedGel(TypedDict):
    """The answer to ``gel``.

    Attributes:
        ok: True.
        file: content of the gel's file, in base64; empty for the gel of the paper.
        text: a sentence for the person.
    """

    ok: Literal[True]
    file: str
    text: str


class Refusal(TypedDict):
    """The answer to a question that the driver refuses.

    Attributes:
        ok: False.
        error: the reason, in a sentence.
        hint: the fix.
        busy: the driver answers others now; ask again.
    """

    ok: Literal[False]
    error: str
    hint: NotRequired[str | None]
    busy: NotRequired[bool]


Answer = Status | Done | Recording | PlayedGel | Refusal


def check_status(answer: dict[str, Any]) -> Status:
    """Returns an answer as the status it is.

    Raises:
        DriverError: it lacks something, or something in it is of another kind.
    """
    for key, kind in get_type_hints(Status).items():
        is_left_out = key in Status.__optional_keys__ and key not in answer
        if not is_left_out and not _fits(answer.get(key), kind):
            raise explain_missing(key)
    return cast(Status, answer)


def explain_missing(key: str) -> DriverError:
    """Returns the error about an answer that lacks a key, or has something else there."""
    return DriverError(
        f"The driver's answer lacks '{key}'.",
        hint="The driver may be of another version than this command: start it again.",
    )


def _fits(value: Any, kind: Any) -> bool:
    """Returns whether a value that was read from JSON is what an annotation promises."""
    origin, inner = get_origin(kind), get_args(kind)
    if is_typeddict(kind):
        hints = get_type_hints(kind)
        return isinstance(value, dict) and all(_fits(value.get(key), hints[key]) for key in hints)
    if origin is Literal:
        return any(type(value) is type(each) and value == each for each in inner)
    if origin in (list, dict):
        parts = value.values() if isinstance(value, dict) else value
        return isinstance(value, origin) and all(_fits(each, inner[-1]) for each in parts)
    if inner:  # one of several, or one that may be left out
        return any(_fits(value, each) for each in inner)
    if isinstance(value, bool):
        return kind is bool
    return isinstance(value, int | float if kind is float else kind)
