"""Examines a machine from Python to the finished gamepad; every failure comes with its fix."""

from neurotouch_hid.doctor.checks import list_checks
from neurotouch_hid.doctor.examination import Check, examine
from neurotouch_hid.doctor.finding import CheckStatus, Finding

__all__ = ["Check", "CheckStatus", "Finding", "examine", "list_checks"]
