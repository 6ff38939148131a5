"""Answers what only a real camera can tell, and compares a rig with the simulated one."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Final

from neurotouch_hid.doctor.directions import View, find_view
from neurotouch_hid.doctor.finding import CheckStatus, Finding
from neurotouch_hid.doctor.hello.meter import strongest
from neurotouch_hid.doctor.hello.session import Session, Span
from neurotouch_hid.geometry import count_turns
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.source.davis import registers as r
from neurotouch_hid.source.davis.enumeration import SUPER_SPEED_MBIT_S
from neurotouch_hid.source.simulator.config import SimulatorConfig
from neurotouch_hid.vocabulary import SourceKind

_TROUBLES: Final = (CheckStatus.FAILED, CheckStatus.WARNING)
_LIKE: Final = 0.2
"""Difference up to which two figures count as the same."""
_WELL: Final = 0.5
"""Share of the prompts whose gesture must be recognised."""
_MOST_NOISE_HZ: Final = 5.0
"""Events/s of a pixel at rest: with more, 450,000 events/s come from noise alone."""
_LEAST_DIRECTION_MM: Final = 2.5


class Word(StrEnum):
    """The first word of an answer."""

    YES = "yes"
    NO = "no"
    OPEN = "not in this run"


@dataclass(frozen=True, slots=True)
class Answer:
    """The answer to one open question about real cameras.

    Attributes:
        point: name of the question, as ``docs/hardware.md`` has it.
        word: the answer in short.
        sentence: the answer.
    """

    point: str
    word: Word
    sentence: str


@dataclass(frozen=True, slots=True)
class Difference:
    """One figure beside that of the simulated gel.

    Attributes:
        name: the figure.
        here: its value; None if this run does not show it.
        simulated: the value of the simulated gel; None if there is nothing to compare with.
        sentence: the same in words.
    """

    name: str
    here: float | None
    simulated: float | None
    sentence: str


@dataclass(frozen=True, slots=True)
class _Figure:
    words: str
    unit: str
    digits: int
    simulated: float | None


_FIGURES: Final = {
    "noise_hz_per_px": _Figure("Noise at rest", "events/s per pixel", 2, 0.98),
    "hot_pixels": _Figure("Pixels that never stop firing", "", 0, 0.0),
    "frame_noise_dn": _Figure("Noise of the frames", "grey levels", 1, 1.5),
    "contrast_dn": _Figure("Contrast of the dots", "grey levels", 0, 108.0),
    "events_per_dot_px": _Figure("Events per dot and pixel of its way", "", 0, 82.0),
    "readout_ratio": _Figure("Events just after a frame's exposure, against others", "", 2, 1.0),
    "blur_px": _Figure("Blur of a dot out of focus", "pixels", 2, 0.0),
    "px_per_mm": _Figure("Scale", "pixels per millimetre", 2, 2.56),
    "rotation_deg": _Figure("Turn of the gel in the picture", "degrees", 1, 0.0),
    "tremble_mm": _Figure("Trembling of a dot at rest", "millimetres", 3, 0.012),
    "kept_share": _Figure("Share of a stroke that the gel keeps", "", 3, 0.0),
    "rim_share": _Figure("Motion at the rim, against the largest", "", 2, 0.115),
}
"""The figures that are compared, with those of the usual simulated rig
(tests/doctor/test_hello.py measures them again)."""

_ABSOLUTE: Final = {
    "kept_share": 0.008,
    "rotation_deg": 2.0,
    "hot_pixels": 2.0,
    "blur_px": 0.3,
    "px_per_mm": 0.1,
}
"""Differences up to which these count as the same: near 0, a share of them says nothing."""

_STIFFNESS: Final = "Stiffness is not measurable without force: nothing here weighs the finger."
_SIMULATED_BANDWIDTH_HZ: Final = SimulatorConfig().sensor.cutoff_hz
"""Of a white pixel."""


def compare(figures: Mapping[str, float | None]) -> list[Difference]:
    """Returns how this gel and camera differ from the simulated ones, a sentence each."""
    found = [_compare(name, figures.get(name)) for name in _FIGURES]
    stiffness = Difference("stiffness", None, None, _STIFFNESS)
    return [*found, stiffness, _compare_bandwidth(figures.get("bandwidth_hz"))]


def _compare_bandwidth(here: float | None) -> Difference:
    simulated = f"The simulated one has {_SIMULATED_BANDWIDTH_HZ:.0f} Hz at white."
    if here is None:
        sentence = "Bandwidth was not measured: that needs events, and an LED given by '--led'."
    else:
        sentence = f"Bandwidth in the light of the LED: at least {here:.0f} Hz. {simulated}"
    return Difference("bandwidth_hz", here, _SIMULATED_BANDWIDTH_HZ, sentence)


def _compare(name: str, here: float | None) -> Difference:
    figure = _FIGURES[name]
    if here is None:
        sentence = f"{figure.words}: this run does not show it."
        return Difference(name, None, figure.simulated, sentence)
    unit = f" {figure.unit}" if figure.unit else ""
    value = f"{here:z.{figure.digits}f}"
    simulated = figure.simulated
    if simulated is None:
        return Difference(name, here, None, f"{figure.words}: {value}{unit}.")
    near = _ABSOLUTE.get(name, _LIKE * abs(simulated))
    if abs(here - simulated) <= near:
        return Difference(name, here, simulated, f"{figure.words}: {value}{unit}, as simulated.")
    way = "more" if here > simulated else "less"
    sentence = (
        f"{figure.words}: {value}{unit}, {way} than the simulated {simulated:.{figure.digits}f}."
    )
    return Difference(name, here, simulated, sentence)


def find_directions(session: Session) -> View | None:
    """Returns how the camera sees the gel, from a push to the right and a clockwise twist."""
    spans = {span.prompt.key: span for span in session.spans}
    push = _find_stroke(spans.get("push_right"), GestureKind.PUSH)
    twist = spans.get("twist_cw")
    turned = _find_stroke(twist, GestureKind.TWIST_CW) or _find_stroke(twist, GestureKind.TWIST_CCW)
    if push is None or turned is None or push.intensity_mm < _LEAST_DIRECTION_MM:
        return None
    n_turns = count_turns(session.gel.layout)
    return find_view(push, turned, session.gel.rotation_deg or 0.0, n_turns)


def _find_stroke(span: Span | None, kind: GestureKind) -> Any:
    return None if span is None else strongest(list(span.strokes), kind)


def answer_all(
    session: Session,
    kind: SourceKind,
    camera: Mapping[str, Any],
    *,
    is_simulated: bool,
    stream: Finding | None = None,
) -> list[Answer]:
    """Returns the answers to all open questions of ``docs/hardware.md``, in its order.

    Args:
        session: what was measured.
        kind: the kind of the source.
        camera: what the camera says of itself.
        is_simulated: a simulation answers nothing about hardware.
        stream: what the doctor says of the data that came; None if it says nothing.
    """
    answers = [
        _answer_play(session),
        _answer_orientation(camera),
        _answer_mirror(session),
        _answer_settings(session, stream),
        _answer_timing(session, camera),
        _answer_usb(session, camera),
        Answer("flush", Word.OPEN, "Whether the camera takes the flush (0xC6) is not noted here."),
        Answer("suspend", Word.OPEN, "The machine was not suspended."),
        _answer_variant(session, kind, camera),
    ]
    if not is_simulated:
        return answers
    return [
        each
        if each.word is Word.OPEN
        else Answer(
            each.point,
            Word.OPEN,
            f"Simulated, so it tells nothing of a camera. Here: {each.word}. {each.sentence}",
        )
        for each in answers
    ]


def _count_recognised(session: Session) -> tuple[int, int]:
    """Returns how many prompted gestures were recognised as such, and how many were tried."""
    tried = [
        span
        for span in session.spans
        if span.prompt.kind not in (None, GestureKind.NONE) and not span.is_skipped
    ]
    right = [span for span in tried if any(each.kind is span.prompt.kind for each in span.strokes)]
    return len(right), len(tried)


def _answer_play(session: Session) -> Answer:
    right, tried = _count_recognised(session)
    if not session.gel.was_found and not session.gel.is_found:
        return Answer("play", Word.NO, "The gel was never found in the pictures.")
    if not tried:
        return Answer("play", Word.OPEN, "The gel was found, but no movement was asked for.")
    word = Word.YES if right > _WELL * tried else Word.NO
    return Answer("play", word, f"{right} of {tried} movements were recognised as asked for.")


def _answer_orientation(camera: Mapping[str, Any]) -> Answer:
    registers = camera.get("registers")
    if registers is None:
        return Answer("orientation", Word.OPEN, "This source reports no orientation.")
    bits = registers["DVS_ORIENTATION"]
    names = [
        name
        for bit, name in (
            (r.ORIENTATION_SWAP, "axes swapped"),
            (r.ORIENTATION_FLIP_COLUMNS, "columns flipped"),
            (r.ORIENTATION_FLIP_ROWS, "rows flipped"),
        )
        if bits & bit
    ]
    how = ", ".join(names) or "nothing swapped or flipped"
    return Answer("orientation", Word.YES, f"The camera reports: {how} (register value {bits}).")


def _answer_mirror(session: Session) -> Answer:
    view = find_directions(session)
    if view is None:
        return Answer("mirrored", Word.OPEN, "It needs a clear push to the right and a twist.")
    if view.is_right:
        return Answer("mirrored", Word.NO, "Directions are right: no setting has to be changed.")
    faults = ["mirrored"] if view.is_mirrored else []
    if view.turned_deg:
        faults.append(f"turned by {view.turned_deg}°")
    word = Word.YES if view.is_mirrored else Word.NO
    fix = "To correct it: neurotouch doctor --directions"
    return Answer("mirrored", word, f"The gel is seen {' and '.join(faults)}. {fix}")


def _answer_timing(session: Session, camera: Mapping[str, Any]) -> Answer:
    figures = session.list_figures()
    usual_ms, most_ms = figures.get("led_latency_ms"), figures.get("led_latency_most_ms")
    if usual_ms is not None:
        sentence = (
            f"From switching on an LED to the slice that shows it: {usual_ms:.1f} ms in the median "
            f"of {figures['led_flashes']:.0f} flashes, {most_ms:.1f} ms at most."
        )
        return Answer("timing", Word.YES, sentence)
    lag_us = camera.get("stamp_to_driver_us")
    sentence = "Latency and what the camera buffers were not measured here."
    if lag_us:
        sentence = (
            f"A picture is here {1e-3 * lag_us:.1f} ms after its stamp. "
            "What the camera does before the stamp was not measured."
        )
    return Answer("timing", Word.OPEN, sentence)


def _answer_settings(session: Session, stream: Finding | None) -> Answer:
    figures = session.list_figures()
    score = session.score
    if stream is not None and stream.status in _TROUBLES:
        return Answer("settings", Word.NO, f"{stream.sentence} {stream.fix}".strip())
    flicker = figures["flicker_hz"]
    if flicker is not None:
        sentence = f"The light flickers at {flicker:.0f} Hz. Use a lamp that is steady."
        return Answer("settings", Word.NO, sentence)
    noise = figures["noise_hz_per_px"]
    if noise is not None and noise > _MOST_NOISE_HZ:
        sentence = f"The sensor is noisy: {noise:.1f} events/s per pixel at rest."
        return Answer("settings", Word.NO, sentence)
    if score is None:
        return Answer("settings", Word.OPEN, "There were no frames to judge.")
    if score.advice:
        return Answer("settings", Word.NO, f"They do not suit yet: {score.advice}")
    sentence = "Light, focus and noise are in order with them."
    if stream is not None:
        sentence = f"{sentence} {stream.sentence}"
    return Answer("settings", Word.YES, sentence)


def _answer_usb(session: Session, camera: Mapping[str, Any]) -> Answer:
    speed = camera.get("usb_mbit_s")
    if speed is None or speed >= SUPER_SPEED_MBIT_S:
        return Answer("usb2", Word.OPEN, "The camera was not seen on USB 2.")
    lost = session.n_lost
    word = Word.NO if lost else Word.YES
    sentence = f"It played on USB 2 at {speed} Mbit/s; {lost:,} events were lost."
    return Answer("usb2", word, sentence)


def _answer_variant(session: Session, kind: SourceKind, camera: Mapping[str, Any]) -> Answer:
    played = session.gel.was_found or session.gel.is_found
    word = Word.YES if played else Word.NO
    how = "showed its gel" if played else "showed no gel"
    if kind in (SourceKind.VIDEO, SourceKind.EVENTS):
        return Answer("variant", word, f"A camera that was never tried before {how}.")
    registers = camera.get("registers")
    if registers is None:
        return Answer("variant", Word.OPEN, "No camera was tried.")
    is_usual = (
        registers["SYSINFO_CHIP"] == r.CHIP
        and not registers["APS_COLOR"]
        and camera.get("firmware") == r.FIRMWARE
    )
    if is_usual:
        return Answer("variant", Word.OPEN, "This camera is the usual one: no other variant.")
    return Answer("variant", word, f"A camera of another variant {how}.")
