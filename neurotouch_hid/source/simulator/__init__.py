"""A simulated gel under a simulated DAVIS-346: scripts in, packets and their truth out."""

from neurotouch_hid.source.simulator.gel import GelConfig
from neurotouch_hid.source.simulator.optics import CameraConfig, LightConfig
from neurotouch_hid.source.simulator.scenes import find_scene, scene_config, scene_names
from neurotouch_hid.source.simulator.script import Finger, Script, Stroke, sequence
from neurotouch_hid.source.simulator.sensor import SensorConfig
from neurotouch_hid.source.simulator.simulator import Simulator, SimulatorConfig
from neurotouch_hid.source.simulator.strokes import (
    Fingertips,
    StrokeTiming,
    pinch,
    press,
    push,
    twist,
    zoom,
)

__all__ = [
    "CameraConfig",
    "Finger",
    "Fingertips",
    "GelConfig",
    "LightConfig",
    "Script",
    "SensorConfig",
    "Simulator",
    "SimulatorConfig",
    "Stroke",
    "StrokeTiming",
    "find_scene",
    "pinch",
    "press",
    "push",
    "scene_config",
    "scene_names",
    "sequence",
    "twist",
    "zoom",
]
