"""Runs the line: builds the stages, turns the crank, keeps the pad safe."""

from neurotouch_hid.runtime.companions import find_companions
from neurotouch_hid.runtime.loop import LoopStats, Tap, run_line
from neurotouch_hid.runtime.pipeline import Pipeline
from neurotouch_hid.runtime.signals import stop_on_signals
from neurotouch_hid.runtime.warmup import warm_up

__all__ = [
    "LoopStats",
    "Pipeline",
    "Tap",
    "find_companions",
    "run_line",
    "stop_on_signals",
    "warm_up",
]
