"""Examines a machine from Python to the finished gamepad; every failure comes with its way out."""

from neurotouch_hid.doctor.checks import list_checks
from neurotouch_hid.doctor.examination import Check, examine
from neurotouch_hid.doctor.finding import Finding, Status

__all__ = ["Check", "Finding", "Status", "examine", "list_checks"]
