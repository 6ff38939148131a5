"""Markers and dots that contradict that each track follows its own marker."""

from itertools import pairwise

import numpy as np

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.tracker.kernels.areas import find_usual_area
from neurotouch_hid.tracker.kernels.unexplained import count_unexplained

REST_PX = Rig((172.0, 130.0), 2.5, 0.0).to_px(PAPER_GEL.points_mm)
NOBODY = np.zeros(177, np.bool_)
INNER = np.hypot(*PAPER_GEL.points_mm.T) < 26.0


def count(points_px, place_px, seen, areas=None, absent=NOBODY):
    areas = np.full(len(points_px), 12) if areas is None else areas
    begin = np.concatenate([[0], np.cumsum(areas)]).astype(np.int32)
    return count_unexplained(points_px, begin, place_px, seen, absent, INNER)


def find_marker(x_mm, y_mm):
    return int(np.hypot(*(PAPER_GEL.points_mm - (x_mm, y_mm)).T).argmin())


def test_a_gel_whose_dots_all_have_their_tracks_is_explained():
    specks_px = np.array([(20.0, 20.0), (172.0, 135.0)])  # one beside the gel, a small one on it
    points_px = np.concatenate([REST_PX, specks_px])
    areas = np.array([12] * 178 + [2])
    assert count(points_px, REST_PX.copy(), ~NOBODY, areas) == (0, 0)


def test_a_row_of_tracks_that_is_one_place_off_leaves_a_dot_behind():
    """Its last marker finds the dot ahead taken, and the dot behind its first one is no one's."""
    row = [find_marker(x, 0.0) for x in (-8.0, -4.0, 0.0, 4.0)]
    place_px, seen = REST_PX.copy(), ~NOBODY
    for here, ahead in pairwise(row):
        place_px[here] = REST_PX[ahead]
    place_px[row[-1]] += (6.0, 6.0)
    seen[row[-1]] = False
    assert count(REST_PX, place_px, seen) == (1, 1)


def test_dots_that_run_together_hide_markers_and_leave_no_dot_over():
    a, b = find_marker(0.0, 0.0), find_marker(4.0, 0.0)
    place_px, seen = REST_PX.copy(), ~NOBODY
    middle_px = 0.5 * (REST_PX[a] + REST_PX[b])
    place_px[a] = place_px[b] = middle_px
    place_px[a, 0] -= 2.0
    place_px[b, 0] += 2.0
    seen[[a, b]] = False
    points_px = np.concatenate([np.delete(REST_PX, [a, b], axis=0), [middle_px]])
    assert count(points_px, place_px, seen, np.array([12] * 175 + [26])) == (0, 0)
    # Beside the dot of another marker, too.
    place_px[a] = REST_PX[find_marker(0.0, 4.0)] + (3.0, 0.0)
    assert count(points_px[:-1], place_px, seen) == (1, 0)


def test_a_marker_that_is_not_seen_at_rest_is_not_missed():
    seen, absent = ~NOBODY, NOBODY.copy()
    seen[88] = False
    points_px = np.delete(REST_PX, 88, axis=0)
    assert count(points_px, REST_PX.copy(), seen) == (1, 0)
    absent[88] = True
    assert count(points_px, REST_PX.copy(), seen, absent=absent) == (0, 0)


def test_the_usual_area_is_the_median_of_as_many_blobs_as_there_are_markers():
    rng = np.random.default_rng(1)
    for n_blobs in (0, 1, 2, 7, 30, 40):
        areas = rng.integers(2, 41, n_blobs)
        begin = np.concatenate([[0], np.cumsum(areas)]).astype(np.int32)
        wanted = np.median(np.sort(areas)[-30:]) if n_blobs else 0.0
        assert find_usual_area(begin, 30) == wanted
