"""Rehearses a profile: written gestures go in, a timeline of its outputs comes out."""

from neurotouch_hid.profile.rehearsal.script import parse_script, rehearse
from neurotouch_hid.profile.rehearsal.timeline import TimelineEntry, perform

__all__ = ["TimelineEntry", "parse_script", "perform", "rehearse"]
