"""The fingers that are followed are the fingers that are there."""

import numpy as np

from neurotouch_hid.geometry import LATTICE_MM
from neurotouch_hid.gesture.elastic.hand import Hand
from tests.gesture.elastic import field

SEES_ALL = np.ones(len(LATTICE_MM))
PLACES = np.array([[-9.0, 0.0], [9.0, 0.0]])


def pinch(size_mm):
    return field(PLACES, np.array([[size_mm, 0.0], [-size_mm, 0.0]]))


def follow(hand, sizes_mm):
    for size_mm in sizes_mm:
        hand.update(pinch(size_mm), SEES_ALL, 0.05, forming=False)


def found(hand):
    order = np.argsort(hand.fit.centres[:, 0])
    return hand.fit.centres[order], hand.fit.motions[order, 0]


def test_two_fingers_are_followed():
    hand = Hand()
    hand.place(LATTICE_MM.copy())
    follow(hand, [1.0, 2.0, 3.0, 4.0])
    centres, drags = found(hand)
    np.testing.assert_allclose(centres, PLACES, atol=1.5)
    np.testing.assert_allclose(drags, [4.0, -4.0], atol=0.5)


def test_fingers_that_ran_into_each_other_are_looked_for_anew():
    hand = Hand()
    hand.place(LATTICE_MM.copy())
    follow(hand, [1.0, 2.0])
    hand.fit.centres[:] = hand.fit.centres[0]  # one place: nothing tells their motions apart
    hand.fit.radii[:] = hand.fit.radii[0]
    follow(hand, [3.0, 4.0])
    centres, drags = found(hand)
    np.testing.assert_allclose(centres, PLACES, atol=1.5)
    np.testing.assert_allclose(drags, [4.0, -4.0], atol=0.5)


def test_a_finger_in_the_wrong_place_is_looked_for_anew():
    hand = Hand()
    hand.place(LATTICE_MM.copy())
    follow(hand, [1.0, 2.0])
    hand.fit.centres[:] = [[0.0, -24.0], [0.0, 24.0]]
    follow(hand, [3.0, 4.0])
    np.testing.assert_allclose(found(hand)[1], [4.0, -4.0], atol=0.5)
