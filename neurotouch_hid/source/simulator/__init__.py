"""A simulated gel under a simulated DAVIS-346: scripts in, packets and their truth out."""

from typing import TYPE_CHECKING

from neurotouch_hid.lazy import load_lazily
from neurotouch_hid.source.simulator.scenes import find_scene, scene_config, scene_names
from neurotouch_hid.source.simulator.script import Finger, Script, Stroke, sequence
from neurotouch_hid.source.simulator.strokes import (
    Fingertips,
    StrokeTiming,
    pinch,
    press,
    push,
    twist,
    zoom,
)

if TYPE_CHECKING:
    from neurotouch_hid.source.simulator.config import (
        CameraConfig,
        GelConfig,
        LightConfig,
        SensorConfig,
        SimulatorConfig,
    )
    from neurotouch_hid.source.simulator.simulator import Simulator
else:  # they have compiled loops, which a check of a scene's name does not need
    __getattr__ = load_lazily(
        __name__,
        {
            "config": "CameraConfig GelConfig LightConfig SensorConfig SimulatorConfig",
            "simulator": "Simulator",
        },
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
