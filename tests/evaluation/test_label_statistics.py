"""What a data set's labels are like."""

import numpy as np

from neurotouch_hid.evaluation.accuracy.label_statistics import LabelStatistics
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import GestureKind
from tests.evaluation.timelines import RIG, label

LABELS = [
    label(0, GestureKind.NONE),
    label(40_000, GestureKind.PUSH, 2.0),
    label(80_000, GestureKind.PUSH, 1.0, [(RIG.centre_px[0] + 10.0, RIG.centre_px[1])]),
]


def test_columns():
    statistics = LabelStatistics.of(LABELS, RIG)
    assert statistics.kinds.tolist() == [0, 1, 1]
    assert statistics.intensity_mm.tolist() == [0.0, 2.0, 1.0]
    np.testing.assert_allclose(statistics.speed_mm_s, [50.0, -25.0])
    np.testing.assert_allclose(statistics.contacts_mm, [[0, 0], [4, 0]], atol=1e-9)


def test_recordings_of_several_rigs_share_the_gel():
    turned = Rig(RIG.centre_px, 5.0, np.pi / 2)
    parts = [LabelStatistics.of(LABELS, rig) for rig in (RIG, turned, None)]
    joined = LabelStatistics.joined(parts)
    np.testing.assert_allclose(joined.contacts_mm[2:], [[0, 0], [0, -2]], atol=1e-9)
    assert len(joined.kinds) == 9
    assert len(joined.speed_mm_s) == 6


def test_one_label_has_no_speed():
    assert len(LabelStatistics.of(LABELS[:1], None).speed_mm_s) == 0
