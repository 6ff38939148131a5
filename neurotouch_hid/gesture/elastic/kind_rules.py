"""Thresholds and times by which a gesture begins and ends, and which kind it is."""

from dataclasses import astuple, dataclass, fields
from typing import Final

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class KindRules:
    """Thresholds and times of ``decide``.

    The size of a gesture is how far dots under a finger go at most, mm.

    Attributes:
        on_mm: a gesture begins above this size, from which people label.
        on_noise: a gesture begins above this size, in errors of a marker. A finger is searched for
            everywhere, so noise draws larger ones than at a single place.
        again_mm: a gesture begins this far above the smallest size since the previous gesture,
            because the gel creeps back for a while.
        swing: after a gesture, the size that begins the next one rises by this share of
            its largest size, because a released gel swings.
        swing_us: time constant with which the rise by ``swing`` fades.
        sway_gain: the size that begins a gesture rises by this multiple of the recent motion of the
            whole gel, because the tracker follows no knock exactly.
        still_mm: if the whole gel recently moved by this much, a gesture takes twice ``on_us`` to
            begin, because the motion may be the start of a knock.
        sway_us: time constant with which the recent motion of the whole gel fades.
        messy_noise: while the whole gel moves, no gesture begins if its fingers leave more than
            this unexplained, in errors of a marker; the larger of this limit and ``messy_share``
            counts.
        messy_share: the limit of ``messy_noise`` as a share of the size. Fingers explain little of
            a knock.
        off_mm: a large gesture ends below this size.
        least_off_mm: the smallest gesture ends below this size, because the gel then has nothing
            to creep back.
        creep: the size at which a gesture ends rises from ``least_off_mm`` by this share of the
            gesture's largest size, up to ``off_mm``.
        kept: a gel keeps up to this share of a gesture's largest size. A gesture that has shrunk
            to it ends as soon as nothing moves any more, for a finger would tremble.
        kept_us: how long nothing must move.
        kept_rate: by this part of its error, what is left of a gesture corrects the share that
            this gel is known to keep. A gesture ends as much earlier.
        still_size_mm: smaller changes of the size are no motion.
        on_us: how long the size must be above the limit before a gesture begins.
        off_us: how long the size must be below the limit before a gesture ends.
        left_us: how long what moves must not look like fingers before a gesture ends whose fingers
            leave. A single slice of a quick motion may not look like any.
        left_noise: the fingers must also leave this much unexplained, in errors of a marker. These
            come from the median, and noise has long tails.
        clear_noise: a frame at rest ends no gesture below ``clear_mm`` that still shrinks while its
            fingers leave less than this unexplained, in errors of a marker.
        clear_mm: see ``clear_noise``. In a frame at rest, three dots may be 0.3 mm away or more. If
            fingers seem to be there that go farther than this, the gel does not come back.
        stalled_us: a gesture whose size has not changed for this long no longer shrinks.
        memory_us: time constant of the evidence for each kind.
        latch_mm: the kind can become final only at or above this size.
        latch_us: how long one kind must have led before it becomes final.
        latch_sure: the kind becomes final only if it is right with this probability, by its lead
            over the next one. Two fingers that push unequally look like a twist at first.
        settle_us: within this time of the begin, a new finger discards the evidence. The fingers of
            one gesture arrive within a tenth of a second of each other.
        overrule: a final kind still changes if another has this many times its evidence.
        moving_mm_s: above this speed a gesture grows or shrinks.
        blur_mm: how sharply people see the first motion of a gesture: width of a logistic curve.
        linger_mm: while fingers leave, this much more size must be left for people to see a
            gesture, because the gel follows late.
        unsure_mm: error of a size that neither noise nor size explains, mostly from the press of
            fingers that touch down.
    """

    on_mm: float = 0.3
    on_noise: float = 4.0
    again_mm: float = 0.1
    swing: float = 0.1
    swing_us: int = 60_000
    sway_gain: float = 2.0
    still_mm: float = 0.05
    sway_us: int = 100_000
    messy_noise: float = 2.5
    messy_share: float = 0.1
    off_mm: float = 0.32
    least_off_mm: float = 0.18
    creep: float = 0.04
    kept: float = 0.075
    kept_us: int = 150_000
    kept_rate: float = 0.5
    still_size_mm: float = 0.06
    on_us: int = 10_000
    off_us: int = 10_000
    left_us: int = 20_000
    left_noise: float = 1.5
    clear_noise: float = 0.3
    clear_mm: float = 0.5
    stalled_us: int = 60_000
    memory_us: int = 60_000
    latch_mm: float = 2.0
    latch_us: int = 40_000
    latch_sure: float = 0.95
    settle_us: int = 250_000
    overrule: float = 3.0
    moving_mm_s: float = 6.0
    blur_mm: float = 0.1
    linger_mm: float = 0.1
    unsure_mm: float = 0.05

    def as_record(self) -> NDArray[np.void]:
        """Returns them as the record (1,) that kernels read."""
        return np.array([astuple(self)], _RECORD)


_RECORD: Final = np.dtype(
    [(f.name, "i8" if f.name.endswith("_us") else "f8") for f in fields(KindRules)]
)
