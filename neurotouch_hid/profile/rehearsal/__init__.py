"""Rehearses a profile: written gestures go in, a timeline of its outputs comes out."""

from neurotouch_hid.profile.rehearsal.script import rehearse
from neurotouch_hid.profile.rehearsal.timeline import perform

__all__ = ["perform", "rehearse"]
