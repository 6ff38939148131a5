"""Runs the line: builds the stages, turns the crank, keeps the pad safe."""

from neurotouch_hid.runtime.commands import SAID, Commands
from neurotouch_hid.runtime.companions import find_companions
from neurotouch_hid.runtime.control import ControlSocket
from neurotouch_hid.runtime.loop import LoopStats, Tap, run_line
from neurotouch_hid.runtime.pipeline import Pipeline
from neurotouch_hid.runtime.reload import ProfileWatch
from neurotouch_hid.runtime.session import Session
from neurotouch_hid.runtime.settings import DriverSettings, load_driver_settings
from neurotouch_hid.runtime.signals import stop_on_signals
from neurotouch_hid.runtime.stopwatch import Stopwatch
from neurotouch_hid.runtime.warmup import warm_up

__all__ = [
    "SAID",
    "Commands",
    "ControlSocket",
    "DriverSettings",
    "LoopStats",
    "Pipeline",
    "ProfileWatch",
    "Session",
    "Stopwatch",
    "Tap",
    "find_companions",
    "load_driver_settings",
    "run_line",
    "stop_on_signals",
    "warm_up",
]
