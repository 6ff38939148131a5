"""The bound of a recording counts what frames cannot label."""

import numpy as np
import pytest

from neurotouch_hid.evaluation.accuracy.label_track import LabelTrack
from neurotouch_hid.messages import GestureKind, Truth
from tests.room.bound import find_bound

BEGIN_US, END_US = 330_000, 610_000


def tell(t_us):
    """Returns the truth of one push with two contacts."""
    is_on = BEGIN_US <= t_us < END_US
    kind = GestureKind.PUSH if is_on else GestureKind.NONE
    return Truth(t_us, kind, np.zeros((2 if is_on else 0, 2)), 1.0 if is_on else 0.0)


def test_a_truth_told_as_late_as_the_labels_are_is_the_bound():
    labels = LabelTrack([tell(t_us) for t_us in range(0, 1_000_001, 40_000)])
    bound = find_bound(labels, [tell(t_us) for t_us in range(10_000, 1_000_001, 10_000)])
    # The begin is labelled 30 ms late and the end 30 ms late, so 30 ms later all is right.
    assert bound == {"type_bound": 1.0, "count_bound": 1.0}


def test_begins_and_ends_that_are_unequally_late_cannot_both_be_met():
    def late(t_us):
        return tell(t_us + 20_000 if t_us > 450_000 else t_us)

    labels = LabelTrack([late(t_us) for t_us in range(0, 1_000_001, 40_000)])
    bound = find_bound(labels, [tell(t_us) for t_us in range(10_000, 1_000_001, 10_000)])
    assert bound["type_bound"] == pytest.approx(0.98, abs=0.011)
