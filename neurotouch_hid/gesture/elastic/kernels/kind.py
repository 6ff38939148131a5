"""Decides over sensor time when a gesture begins and ends, and which kind it is."""

import math
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel
from neurotouch_hid.vocabulary import GestureKind

Record = Any  # of a dtype below, of ``KindRules`` or ``MOTION``

SPEED_US: Final = 30_000  # time constant of the speed with which a gesture grows
LEAST_MM: Final = 0.3  # another kind overrules one with less evidence than this as if it had this

DECISION: Final = np.dtype(
    [
        ("kind", "i8"),
        ("confidence", "f8"),
        ("is_latched", "?"),
        ("is_ending", "?"),
        ("age_us", "i8"),
        ("evidence_mm", "f8", len(GestureKind)),
        ("size_mm", "f8"),
        ("most_mm", "f8"),
        ("speed_mm_s", "f8"),
        ("n_fingers", "i8"),
        ("above_us", "i8"),
        ("below_us", "i8"),
        ("left_us", "i8"),
        ("led_us", "i8"),
        ("least_mm", "f8"),
        ("sway_mm", "f8"),
        ("swing_mm", "f8"),
        ("stays_mm", "f8"),
        ("stays_us", "i8"),
        ("kept_share", "f8"),
        ("left_by_mm", "f8"),
    ],
    align=True,
)
"""What is decided, and what must be remembered for it.

Of the gesture, and forgotten with it:

- ``kind``, ``confidence``: the ``GestureKind``, and how probably people see it, 0..1.
- ``is_latched``: the kind is final.
- ``is_ending``: the fingers leave, or have just left.
- ``age_us``: time since the begin.
- ``evidence_mm``: the recent mean of the motion that speaks for each ``GestureKind``.
- ``size_mm``, ``most_mm``, ``speed_mm_s``: the size, the largest so far, and how fast it grows.
- ``n_fingers``: the number of fingers.
- ``above_us``, ``below_us``, ``left_us``: for how long a gesture would begin, would end, and looks
  like no fingers.
- ``led_us``: for how long one kind has led.

Of the gel:

- ``least_mm``: the smallest size since the previous gesture.
- ``sway_mm``, ``swing_mm``: recent motion of the whole gel, and what a released one swings by.
- ``stays_mm``, ``stays_us``: the size that has not changed, and for how long.
- ``kept_share``: the share of a large gesture that this gel keeps.
- ``left_by_mm``: the largest size of the previous gesture, until it is known what is left of it.
"""


@kernel
def forget(decision: NDArray[np.void]) -> None:
    """Forgets the gesture, but nothing of the gel, in a ``DECISION`` (1,)."""
    _forget(decision[0])


@kernel
def _forget(d: Record) -> None:
    d.kind, d.confidence = 0, 1.0
    d.is_latched = d.is_ending = False
    d.age_us = 0
    d.evidence_mm[:] = 0.0
    d.size_mm = d.most_mm = d.speed_mm_s = 0.0
    d.n_fingers = 0
    d.above_us = d.below_us = d.left_us = d.led_us = 0


@kernel
def decide(
    d: Record, c: Record, m: Record, step_us: int, noise_mm: float, rest_age_us: int
) -> None:
    """Takes one slice.

    Args:
        d: ``DECISION``, updated.
        c: ``KindRules``.
        m: ``MOTION`` of this slice.
        step_us: time since the previous slice.
        noise_mm: error of a marker on one axis.
        rest_age_us: how long ago the gel was seen at rest.
    """
    size_mm = m.peak_mm
    error_mm = math.sqrt(c.unsure_mm**2 + (noise_mm / 3.0) ** 2 + (0.02 * size_mm) ** 2)
    d.sway_mm = max(m.sway_mm, math.exp(-step_us / c.sway_us) * d.sway_mm)
    d.swing_mm *= math.exp(-step_us / c.swing_us)
    _time_stay(d, c, m, step_us)
    if d.kind == 0:
        d.least_mm = min(d.least_mm, m.largest_mm)
        _learn_kept(d, c, m)
    begins = _is_large(d, c, m, noise_mm) and not _is_knock(d, c, m, noise_mm)
    off_mm = min(c.off_mm, c.least_off_mm + c.creep * d.most_mm)
    off_mm += d.kept_share * d.most_mm
    d.above_us = d.above_us + step_us if begins else 0
    d.below_us = d.below_us + step_us if size_mm < off_mm else 0
    d.left_us = d.left_us + step_us if _is_left(d, c, m, noise_mm) else 0
    on_us = c.on_us if d.sway_mm < c.still_mm else 2 * c.on_us
    if d.kind == 0 and d.above_us < on_us:
        d.size_mm = size_mm
        d.confidence = 1.0 - _believe(d, c, size_mm)
        return
    is_over = (
        d.below_us >= c.off_us
        or d.left_us >= c.left_us
        or _is_kept(d, c, m)
        or _is_seen_over(d, c, m, noise_mm, rest_age_us)
    )
    if d.kind != 0 and is_over:
        d.swing_mm = max(d.swing_mm, c.swing * d.most_mm)
        d.left_by_mm = d.most_mm
        _forget(d)
        d.least_mm = m.largest_mm
        d.confidence = 1.0 - _believe(d, c, size_mm)
        return
    d.age_us += step_us
    d.most_mm = max(d.most_mm, size_mm)
    if m.n_fingers > d.n_fingers and d.age_us < c.settle_us:
        d.evidence_mm[:] = 0.0  # fewer fingers gave it
        d.is_latched, d.led_us = False, 0
    d.n_fingers = m.n_fingers
    _follow(d, c, step_us, size_mm)
    if d.kind == 0 or d.is_latched or not is_falling(d, c):
        _weigh(d, c, m, step_us, error_mm)  # what leaves tells no type: the gel swings back
    d.confidence = _believe(d, c, size_mm) * _prefer(d, error_mm)


@kernel(inline="always")
def is_forming(d: Record) -> bool:
    """Returns True while the gesture may still become another kind."""
    return bool(d.kind == 0 or not d.is_latched)


@kernel(inline="always")
def is_falling(d: Record, c: Record) -> bool:
    """Returns True while the fingers leave the gel."""
    return bool(d.speed_mm_s < -c.moving_mm_s)


@kernel
def _is_large(d: Record, c: Record, m: Record, noise_mm: float) -> bool:
    """Returns True if people see a gesture, and it is more than what is left of the last one.

    What is left is a drag. Its turn is noise, which would begin the same gesture again.
    """
    more_mm = c.sway_gain * d.sway_mm + d.swing_mm
    on_mm = max(c.on_mm, c.on_noise * noise_mm)
    is_seen = m.peak_mm >= on_mm + more_mm
    return bool(is_seen and m.largest_mm >= d.least_mm + c.again_mm + more_mm)


@kernel
def _is_knock(d: Record, c: Record, m: Record, noise_mm: float) -> bool:
    """Returns True if the whole gel moves and the fingers explain too little of the rest."""
    if d.sway_mm < c.still_mm or m.peak_mm >= c.latch_mm:
        return False
    return bool(m.error_mm > max(c.messy_noise * noise_mm, c.messy_share * m.peak_mm))


@kernel
def _time_stay(d: Record, c: Record, m: Record, step_us: int) -> None:
    """Measures how long the size has not changed."""
    if abs(m.largest_mm - d.stays_mm) > c.still_size_mm:
        d.stays_mm, d.stays_us = m.largest_mm, 0
    else:
        d.stays_us += step_us


@kernel
def _is_kept(d: Record, c: Record, m: Record) -> bool:
    """Returns True if the size is what the gel keeps of a large gesture."""
    return bool(d.stays_us >= c.kept_us and m.largest_mm < c.kept * d.most_mm)


@kernel
def _learn_kept(d: Record, c: Record, m: Record) -> None:
    """Learns which share of a large gesture the gel keeps, once nothing moves any more."""
    if d.stays_us < c.kept_us:
        return
    if d.left_by_mm >= c.latch_mm:
        share = min(m.largest_mm / d.left_by_mm, c.kept)
        d.kept_share += c.kept_rate * (share - d.kept_share)
    d.left_by_mm = 0.0


@kernel
def _is_left(d: Record, c: Record, m: Record, noise_mm: float) -> bool:
    """Returns True if the fingers leave, and what still moves does not look like fingers.

    Tracks that lose their markers in a motion stay behind, each by itself.
    """
    if not m.is_lost or m.error_mm < c.left_noise * noise_mm:
        return False
    return bool(d.is_ending and m.peak_mm < c.latch_mm)


@kernel
def _is_seen_over(d: Record, c: Record, m: Record, noise_mm: float, rest_age_us: int) -> bool:
    """Returns True if the fingers leave, and a frame since the begin shows the gel at rest.

    The frame is late, so the fingers may be back: a large gesture goes on. So does a small one that
    still shrinks while its fingers explain the markers: they tell its size better than such a
    frame, in which three dots may be elsewhere.
    """
    if rest_age_us >= d.age_us or not d.is_ending or m.peak_mm >= c.latch_mm:
        return False
    is_clear = m.error_mm < c.clear_noise * noise_mm and m.peak_mm < c.clear_mm
    return bool(not is_clear or d.stays_us >= c.stalled_us)


@kernel
def _believe(d: Record, c: Record, size_mm: float) -> float:
    """Returns the probability that people see a gesture of this size."""
    middle_mm = 0.5 * (c.on_mm + c.off_mm)
    if d.is_ending:
        middle_mm += c.linger_mm
    return 1.0 / (1.0 + math.exp(-(size_mm - middle_mm) / c.blur_mm))


@kernel
def _prefer(d: Record, error_mm: float) -> float:
    """Returns the probability of the kind: its lead over the next one, in standard errors."""
    next_mm = -math.inf
    for kind in range(len(d.evidence_mm)):
        if kind != d.kind:
            next_mm = max(next_mm, d.evidence_mm[kind])
    lead_mm = d.evidence_mm[d.kind] - next_mm
    return 0.5 * (1.0 + math.erf(lead_mm / error_mm / 2.0))


@kernel
def _follow(d: Record, c: Record, step_us: int, size_mm: float) -> None:
    rate = (size_mm - d.size_mm) / max(step_us, 1) * 1e6
    share = 1.0 - math.exp(-step_us / SPEED_US)
    d.speed_mm_s += share * (rate - d.speed_mm_s)
    d.size_mm = size_mm
    if is_falling(d, c):
        d.is_ending = True
    elif d.speed_mm_s > c.moving_mm_s or size_mm > 0.5 * d.most_mm:
        d.is_ending = False


@kernel
def _weigh(d: Record, c: Record, m: Record, step_us: int, error_mm: float) -> None:
    keep = math.exp(-step_us / c.memory_us)
    best = 0
    for kind in range(len(d.evidence_mm)):
        d.evidence_mm[kind] = keep * d.evidence_mm[kind] + (1 - keep) * m.parts_mm[kind]
        if d.evidence_mm[kind] > d.evidence_mm[best]:
            best = kind
    best_mm, kind_mm = d.evidence_mm[best], d.evidence_mm[d.kind]
    if d.kind == 0:
        d.kind = best
        return
    if d.is_latched:
        if best_mm > c.overrule * max(kind_mm, LEAST_MM):
            d.kind = best
        return
    d.led_us = d.led_us + step_us if best == d.kind else 0
    if best_mm > 1.1 * kind_mm:
        d.kind = best
    is_told = m.largest_mm >= c.latch_mm and d.led_us >= c.latch_us
    d.is_latched = is_told and _prefer(d, error_mm) >= c.latch_sure
