"""The two halves of ``recognize``, one by one: the fingers of a slice, and the decision."""

from types import SimpleNamespace

import numpy as np

from neurotouch_hid.gesture.elastic.fingers import FingerTracker
from neurotouch_hid.gesture.elastic.kernels.arrays import MOTION
from neurotouch_hid.gesture.elastic.kernels.follow import follow
from neurotouch_hid.gesture.elastic.kernels.kind import DECISION, decide, forget, is_falling
from neurotouch_hid.gesture.elastic.kernels.kind import is_forming as is_still_forming
from neurotouch_hid.gesture.elastic.kernels.search import CHECK_US
from neurotouch_hid.gesture.elastic.kind_rules import KindRules
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.process.kernel_cache import kernel

NEVER_US = 1 << 60  # ago


class Fingers(FingerTracker):
    """One that follows the fingers, whatever is decided about their motion."""

    def update(self, moved_px, use, noise_mm, *, step_us=CHECK_US, forming, falling=False):
        """Returns the ``MOTION`` of one slice."""
        state = self.arrays.state
        state["slice"] = noise_mm, step_us, forming, falling
        follow(self.arrays, moved_px, use)
        motion = state["motion"][0].copy()
        return SimpleNamespace(**{name: motion[name] for name in MOTION.names})


@kernel
def decide_slice(decision, rules, motion, step_us, noise_mm, rest_age_us):
    d, c = decision[0], rules[0]
    decide(d, c, motion[0], step_us, noise_mm, rest_age_us)
    return is_still_forming(d), is_falling(d, c)


class Decider:
    """One that is told the motion of each slice of 10 ms."""

    def __init__(self):
        self.motion, self.decision = np.zeros(1, MOTION), np.zeros(1, DECISION)
        self._rules = KindRules().as_record()
        self.is_forming, self.is_falling = True, False
        forget(self.decision)

    @property
    def kind(self):
        return GestureKind(self.decision["kind"].item())

    @property
    def confidence(self):
        return self.decision["confidence"].item()

    def tell(self, *motion, noise_mm=0.05, rest_age_us=NEVER_US):
        self.motion[0] = motion
        self.is_forming, self.is_falling = decide_slice(
            self.decision, self._rules, self.motion, 10_000, noise_mm, rest_age_us
        )
        return self.kind
