"""Decides over sensor time when a gesture begins and ends, and which kind it is."""

import math
from dataclasses import dataclass

from neurotouch_hid.gesture.elastic.fingers import FingerMotion
from neurotouch_hid.messages import GestureKind


@dataclass(frozen=True, slots=True)
class KindDeciderConfig:
    """Thresholds and times of ``KindDecider``.

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


class KindDecider:
    """Decides the kind of one gesture at a time, from rest to rest."""

    def __init__(self, config: KindDeciderConfig | None = None) -> None:
        self._config = config or KindDeciderConfig()
        self._least_mm = self._sway_mm = self._swing_mm = 0.0
        self._stays_mm, self._stays_us = 0.0, 0
        self._kept_share = self._left_by_mm = 0.0
        self.reset()

    def reset(self) -> None:
        """Returns to rest."""
        self.kind = GestureKind.NONE
        self.confidence = 1.0
        self.is_latched = False
        self._age_us = 0
        self._evidence = [0.0] * len(GestureKind)
        self._size_mm = self._most_mm = self._speed_mm_s = 0.0
        self._is_ending = False
        self._n_fingers = 0
        self._above_us = self._below_us = self._left_us = self._led_us = 0

    @property
    def is_forming(self) -> bool:
        """True while the gesture may still become another kind."""
        return self.kind is GestureKind.NONE or not self.is_latched

    @property
    def is_falling(self) -> bool:
        """True while the fingers leave the gel."""
        return self._speed_mm_s < -self._config.moving_mm_s

    def update(
        self, step_us: int, motion: FingerMotion, noise_mm: float, rest_age_us: int | None = None
    ) -> None:
        """Takes one slice.

        Args:
            step_us: time since the previous slice.
            motion: the motion of the fingers in this slice; only ``largest_mm``, ``peak_mm``,
                ``parts_mm``, ``n_fingers``, ``sway_mm``, ``error_mm`` and ``is_lost`` are read.
            noise_mm: error of a marker on one axis.
            rest_age_us: how long ago the gel was seen at rest, if a frame has just told so.
        """
        size_mm = motion.peak_mm
        config = self._config
        self._sway_mm = max(motion.sway_mm, math.exp(-step_us / config.sway_us) * self._sway_mm)
        self._swing_mm *= math.exp(-step_us / config.swing_us)
        self._time_stay(step_us, motion.largest_mm)
        if self.kind is GestureKind.NONE:
            self._least_mm = min(self._least_mm, motion.largest_mm)
            self._learn_kept(motion.largest_mm)
        begins = self._is_large(motion, noise_mm) and not self._is_knock(
            size_mm, noise_mm, motion.error_mm
        )
        off_mm = min(config.off_mm, config.least_off_mm + config.creep * self._most_mm)
        off_mm += self._kept_share * self._most_mm
        self._above_us = self._above_us + step_us if begins else 0
        self._below_us = self._below_us + step_us if size_mm < off_mm else 0
        self._left_us = self._left_us + step_us if self._is_left(motion, noise_mm) else 0
        on_us = config.on_us if self._sway_mm < config.still_mm else 2 * config.on_us
        if self.kind is GestureKind.NONE and self._above_us < on_us:
            self._size_mm = size_mm
            self.confidence = 1.0 - self._believe(size_mm)
            return
        is_over = (
            self._below_us >= config.off_us
            or self._left_us >= config.left_us
            or self._is_kept(motion.largest_mm)
            or self._is_seen_over(rest_age_us, size_mm)
        )
        if self.kind is not GestureKind.NONE and is_over:
            self._swing_mm = max(self._swing_mm, config.swing * self._most_mm)
            self._left_by_mm = self._most_mm
            self.reset()
            self._least_mm = motion.largest_mm
            self.confidence = 1.0 - self._believe(size_mm)
            return
        self._age_us += step_us
        self._most_mm = max(self._most_mm, size_mm)
        if motion.n_fingers > self._n_fingers and self._age_us < config.settle_us:
            self._evidence = [0.0] * len(GestureKind)  # fewer fingers gave it
            self.is_latched, self._led_us = False, 0
        self._n_fingers = motion.n_fingers
        self._follow(step_us, size_mm)
        if self.kind is GestureKind.NONE or self.is_latched or not self.is_falling:
            self._weigh(step_us, motion, noise_mm)  # what leaves tells no type: the gel swings back
        self.confidence = self._believe(size_mm) * self._prefer(size_mm, noise_mm)

    def _is_large(self, motion: FingerMotion, noise_mm: float) -> bool:
        """Returns True if people see a gesture, and it is more than what is left of the last one.

        What is left is a drag. Its turn is noise, which would begin the same gesture again.
        """
        config = self._config
        more_mm = config.sway_gain * self._sway_mm + self._swing_mm
        on_mm = max(config.on_mm, config.on_noise * noise_mm)
        is_seen = motion.peak_mm >= on_mm + more_mm
        return is_seen and motion.largest_mm >= self._least_mm + config.again_mm + more_mm

    def _is_knock(self, size_mm: float, noise_mm: float, error_mm: float) -> bool:
        """Returns True if the whole gel moves and the fingers explain too little of the rest."""
        config = self._config
        if self._sway_mm < config.still_mm or size_mm >= config.latch_mm:
            return False
        return error_mm > max(config.messy_noise * noise_mm, config.messy_share * size_mm)

    def _time_stay(self, step_us: int, size_mm: float) -> None:
        """Measures how long the size has not changed."""
        if abs(size_mm - self._stays_mm) > self._config.still_size_mm:
            self._stays_mm, self._stays_us = size_mm, 0
        else:
            self._stays_us += step_us

    def _is_kept(self, size_mm: float) -> bool:
        """Returns True if the size is what the gel keeps of a large gesture."""
        config = self._config
        return self._stays_us >= config.kept_us and size_mm < config.kept * self._most_mm

    def _learn_kept(self, size_mm: float) -> None:
        """Learns which share of a large gesture the gel keeps, once nothing moves any more."""
        config = self._config
        if self._stays_us < config.kept_us:
            return
        if self._left_by_mm >= config.latch_mm:
            share = min(size_mm / self._left_by_mm, config.kept)
            self._kept_share += config.kept_rate * (share - self._kept_share)
        self._left_by_mm = 0.0

    def _is_left(self, motion: FingerMotion, noise_mm: float) -> bool:
        """Returns True if the fingers leave, and what still moves does not look like fingers.

        Tracks that lose their markers in a motion stay behind, each by itself.
        """
        if not motion.is_lost or motion.error_mm < self._config.left_noise * noise_mm:
            return False
        return self._is_ending and motion.peak_mm < self._config.latch_mm

    def _is_seen_over(self, rest_age_us: int | None, size_mm: float) -> bool:
        """Returns True if the fingers leave, and a frame since the begin shows the gel at rest.

        The frame is late, so the fingers may be back: a large gesture goes on.
        """
        if rest_age_us is None or rest_age_us >= self._age_us:
            return False
        return self._is_ending and size_mm < self._config.latch_mm

    def _believe(self, size_mm: float) -> float:
        """Returns the probability that people see a gesture of this size."""
        middle = 0.5 * (self._config.on_mm + self._config.off_mm)
        if self._is_ending:
            middle += self._config.linger_mm
        return 1.0 / (1.0 + math.exp(-(size_mm - middle) / self._config.blur_mm))

    def _prefer(self, size_mm: float, noise_mm: float) -> float:
        """Returns the probability of the kind: its lead over the next one, in standard errors."""
        others = self._evidence.copy()
        lead = others.pop(self.kind) - max(others)
        error = math.hypot(self._config.unsure_mm, noise_mm / 3.0, 0.02 * size_mm)
        return 0.5 * (1.0 + math.erf(lead / error / 2.0))

    def _follow(self, step_us: int, size_mm: float) -> None:
        rate = (size_mm - self._size_mm) / max(step_us, 1) * 1e6
        share = 1.0 - math.exp(-step_us / 30_000)
        self._speed_mm_s += share * (rate - self._speed_mm_s)
        self._size_mm = size_mm
        if self.is_falling:
            self._is_ending = True
        elif self._speed_mm_s > self._config.moving_mm_s or size_mm > 0.5 * self._most_mm:
            self._is_ending = False

    def _weigh(self, step_us: int, motion: FingerMotion, noise_mm: float) -> None:
        config = self._config
        keep = math.exp(-step_us / config.memory_us)
        self._evidence = [
            keep * e + (1 - keep) * part
            for e, part in zip(self._evidence, motion.parts_mm.tolist(), strict=True)
        ]
        best = GestureKind(self._evidence.index(max(self._evidence)))
        if self.kind is GestureKind.NONE:
            self.kind = best
            return
        if self.is_latched:
            if self._evidence[best] > config.overrule * max(self._evidence[self.kind], 0.3):
                self.kind = best
            return
        self._led_us = self._led_us + step_us if best is self.kind else 0
        if self._evidence[best] > 1.1 * self._evidence[self.kind]:
            self.kind = best
        is_told = motion.largest_mm >= config.latch_mm and self._led_us >= config.latch_us
        self.is_latched = is_told and self._prefer(motion.peak_mm, noise_mm) >= config.latch_sure
