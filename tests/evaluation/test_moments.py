"""Which moments are the worst."""

import pytest

from neurotouch_hid.evaluation.accuracy.moments import N_WORST, WorstMoments, measure_severity
from neurotouch_hid.messages import GestureKind
from tests.evaluation.timelines import RIG, answer, label, markers

CENTRE = RIG.centre_px
PUSH = label(0, GestureKind.PUSH, 8.0)
NONE = label(0, GestureKind.NONE)
ZOOM = GestureKind.ZOOM


@pytest.mark.parametrize(
    ("truth", "wrong", "severity_mm"),
    [
        (PUSH, {}, 0.0),
        (PUSH, {"intensity": 5.0}, 3.0),
        (PUSH, {"kind": ZOOM}, 8.0),
        (PUSH, {"kind": ZOOM, "intensity": 10.0}, 2.0 + 10.0),
        (PUSH, {"contacts": [CENTRE, CENTRE]}, 8.0 / 2),
        (PUSH, {"contacts": [(CENTRE[0] + 6 * RIG.px_per_mm, CENTRE[1])]}, 8.0 / 2),
        (PUSH, {"contacts": [(CENTRE[0] + 50 * RIG.px_per_mm, CENTRE[1])]}, 8.0),
        (PUSH, {"kind": GestureKind.NONE, "contacts": [], "intensity": 0.0}, 8.0 + 8.0 * 2),
        (NONE, {}, 0.0),
        (NONE, {"kind": ZOOM, "intensity": 3.0}, 3.0 + 3.0),
    ],
)
def test_severity(truth, wrong, severity_mm):
    assert measure_severity(answer(truth, **wrong), truth, RIG) == pytest.approx(severity_mm)


def feed(worst, truths, errors_mm):
    for truth, error_mm in zip(truths, errors_mm, strict=True):
        gesture = answer(truth, intensity=truth.intensity_mm + error_mm)
        worst.add(truth.t_us / 1e6, markers(truth.t_us), gesture, truth, RIG)


def test_one_moment_of_each_stretch_the_worst_ten_of_all():
    worst = WorstMoments()
    n = N_WORST + 4
    for k in range(n):
        kind = (GestureKind.PUSH, GestureKind.NONE)[k % 2]
        truths = [label(1_000_000 * k + 10_000 * i, kind, 1.0) for i in range(3)]
        feed(worst, truths, (0.5 * k, k, 0.9 * k))
    ranked = worst.ranked()
    strengths = [moment.gesture.intensity_mm for moment in ranked]
    assert strengths == [1.0 + k for k in reversed(range(n - N_WORST, n))]
    assert [moment.since_s for moment in ranked[:2]] == [n - 1 + 0.01, n - 2 + 0.01]


def test_what_is_right_is_no_failure():
    worst = WorstMoments()
    feed(worst, [PUSH, NONE], (0.0, 0.0))
    assert worst.ranked() == []
