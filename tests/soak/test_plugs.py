"""A camera pulled in a gesture; ``python -m tests.soak.plugs 1000`` does it often."""

from statistics import median

from tests.soak.plugs import pull_and_plug


def test_a_camera_that_is_pulled_and_plugged_leaves_the_pad_neutral_and_nothing_behind(folder):
    result = pull_and_plug(6)
    assert result.n_connects == 6
    assert median(result.neutral_s) < 0.1
    (descriptors, threads, _), *later = result.weights
    assert [each[:2] for each in later] == [(descriptors, threads)] * len(later)
    assert later
