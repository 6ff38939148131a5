"""The outliers of the global pattern."""

import numpy as np

from neurotouch_hid.gesture.paper.contacts import find_outliers


def test_outliers_are_the_markers_that_leave_the_pattern():
    grid = np.stack(np.meshgrid(np.arange(9.0), np.arange(9.0)), -1).reshape(-1, 2) * 10
    moved = np.hypot(*(grid - (60.0, 50.0)).T) < 16
    target = grid * 1.1 + 4.0 * moved[:, None]
    assert moved.sum() > 5
    assert find_outliers(grid, target, 1.0).tolist() == moved.tolist()


def test_too_few_markers_have_no_pattern_to_leave():
    three = np.array([[0.0, 0.0], [10.0, 0.0], [0.0, 10.0]])
    assert not find_outliers(three, three + 5.0, 1.0).any()


def test_markers_on_a_line_are_no_outliers():
    line = np.stack([np.linspace(0, 100, 12), np.linspace(0, 100, 12)], axis=1)
    assert not find_outliers(line, line, 1.0).any()
