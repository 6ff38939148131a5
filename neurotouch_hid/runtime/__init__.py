"""Runs one pipeline in time: builds the stages, feeds them slices, keeps the pad safe."""

from neurotouch_hid.runtime.loop import LoopStats, Tap, run_pipeline
from neurotouch_hid.runtime.pipeline import Pipeline
from neurotouch_hid.runtime.pipeline_control import PipelineControl
from neurotouch_hid.runtime.warmup import warm_up, warm_up_gestures

__all__ = [
    "LoopStats",
    "Pipeline",
    "PipelineControl",
    "Tap",
    "run_pipeline",
    "warm_up",
    "warm_up_gestures",
]
