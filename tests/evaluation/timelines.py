"""Labels, answers and tracked markers made by hand."""

import numpy as np

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.messages import Gesture, GestureKind, MarkerField, Truth

RIG = Rig((170.0, 130.0), 2.5)
REST_PX = RIG.to_px(PAPER_GEL.points_mm).astype(np.float32)


def points(values):
    return np.array(values, float).reshape(-1, 2)


def label(t_us, kind, intensity=0.0, contacts=None):
    """A label; a gesture has one contact at the gel's centre unless told otherwise."""
    if contacts is None:
        contacts = [] if kind is GestureKind.NONE else [RIG.centre_px]
    return Truth(t_us, kind, points(contacts), float(intensity))


def answer(truth, *, kind=None, intensity=None, contacts=None, confidence=1.0):
    """What would be right, but for what is told otherwise."""
    contacts = truth.contacts_px if contacts is None else points(contacts)
    return Gesture(
        truth.t_us,
        truth.kind if kind is None else kind,
        RIG.to_mm(contacts),
        contacts,
        truth.intensity_mm if intensity is None else intensity,
        confidence=confidence,
    )


def markers(t_us, moved_px=(0.0, 0.0)):
    """All markers measured and moved alike, but for the first, which is lost."""
    position_px = REST_PX + np.array(moved_px, np.float32)
    valid = np.ones(len(REST_PX), bool)
    valid[0] = False
    return MarkerField(t_us, REST_PX, position_px, valid)
