"""Losses and delays between sensor and computer, and changes of the clock."""

from dataclasses import replace

import numpy as np

from neurotouch_hid.events import pick_events
from neurotouch_hid.messages import Frame
from neurotouch_hid.source.simulator.setup import ClockChange, Piece, Setup

LOSS_PERIOD_US = 500_000  # how often events get lost
JUMP_AT = 0.4  # share of the play


def frames(setup: Setup, per_s: float) -> Setup:
    """Lets only so many frames a second arrive; 0 is none."""
    period_us = setup.config.sensor.frame_us
    most = 1e6 / period_us

    def wire(piece: Piece) -> Piece:
        kept = [
            frame
            for frame in piece.frames
            if _is_due(frame.exposure_begin_us // period_us, min(per_s / most, 1.0))
        ]
        return replace(piece, frames=tuple(kept))

    return setup.plus(wires=wire)


def dropped(setup: Setup, percent: float) -> Setup:
    """Loses ``percent`` % of all frames, here and there."""
    rng = setup.random("dropped")

    def wire(piece: Piece) -> Piece:
        kept = tuple(frame for frame in piece.frames if rng.random() >= 0.01 * percent)
        return replace(piece, frames=kept)

    return setup.plus(wires=wire)


def doubled(setup: Setup, percent: float) -> Setup:
    """Sends the frame before again instead of ``percent`` % of all frames."""
    rng = setup.random("doubled")
    last: Frame | None = None

    def wire(piece: Piece) -> Piece:
        nonlocal last
        sent = []
        for frame in piece.frames:
            if last is not None and rng.random() < 0.01 * percent:
                frame = replace(frame, pixels=last.pixels)  # noqa: PLW2901
            last = frame
            sent.append(frame)
        return replace(piece, frames=tuple(sent))

    return setup.plus(wires=wire)


def late(setup: Setup, ms: float) -> Setup:
    """Stamps each frame so much later than it was exposed."""
    late_us = round(1000 * ms)

    def wire(piece: Piece) -> Piece:
        shifted = tuple(
            replace(
                frame,
                exposure_begin_us=frame.exposure_begin_us + late_us,
                exposure_end_us=frame.exposure_end_us + late_us,
            )
            for frame in piece.frames
        )
        return replace(piece, frames=shifted)

    return setup.plus(wires=wire)


def black(setup: Setup, percent: float) -> Setup:
    """Makes ``percent`` % of all frames black, here and there."""
    rng = setup.random("black")

    def wire(piece: Piece) -> Piece:
        seen = tuple(
            replace(frame, pixels=np.zeros_like(frame.pixels))
            if rng.random() < 0.01 * percent
            else frame
            for frame in piece.frames
        )
        return replace(piece, frames=seen)

    return setup.plus(wires=wire)


def lost(setup: Setup, ms: float) -> Setup:
    """Loses all events for N ms, twice a second."""
    rng = setup.random("lost")
    begins = np.arange(0, setup.duration_us, LOSS_PERIOD_US)
    begins += rng.integers(0, LOSS_PERIOD_US // 2, len(begins))

    def wire(piece: Piece) -> Piece:
        t_us = piece.events["t"] % setup.duration_us
        since = t_us - begins[np.maximum(np.searchsorted(begins, t_us, "right") - 1, 0)]
        came = (since < 0) | (since >= 1000 * ms)
        return replace(piece, events=pick_events(piece.events, came))

    return setup.plus(wires=wire)


def jump(setup: Setup, s: float) -> Setup:
    """Sets the camera's clock forward by so much, once."""
    return setup.plus(clock=ClockChange(_round(JUMP_AT * setup.duration_us), 0, round(1e6 * s)))


def pause(setup: Setup, s: float) -> Setup:
    """Lets nothing arrive for N s, once."""
    return setup.plus(clock=ClockChange(_round(JUMP_AT * setup.duration_us), round(1e6 * s)))


def hand_on(setup: Setup, s: float) -> Setup:
    """Switches the camera on only N s after the first finger has touched the gel."""
    first = min((stroke.start_us for stroke in setup.strokes), default=0)
    off_us = _round(first + 1e6 * s)
    return setup.plus(clock=ClockChange(0, off_us, -off_us))


def _is_due(index: int, share: float) -> bool:
    """Returns True for this share of all indices, evenly, and for the first."""
    return (share > 0.0 and int(index * share) != int((index - 1) * share)) or (
        index == 0 and share > 0.0
    )


def _round(t_us: float) -> int:
    return round(t_us / 1000) * 1000
