"""Films scripts of the simulator. It is apart from the camera, for which nothing is compiled."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from neurotouch_devtools.emulator.uvc.film import PERIOD_US, Film
from neurotouch_hid.source.simulator import (
    Script,
    Simulator,
    SimulatorConfig,
    find_scene,
    scene_config,
)
from neurotouch_hid.source.simulator.scenes import read_simulation

EXPOSURE_US = 4_000
_MOST_US = 30_000_000


def film_scene(name: str, *, seed: int = 0) -> Film:
    """Films a scene of the simulator, 30 s at most.

    Args:
        name: ``NAME[,NUISANCE[=STRENGTH]]...``.
        seed: of the simulator's chance.

    Raises:
        SourceError: there is no such scene or nuisance.
    """
    scene, nuisances = read_simulation(name)
    script = find_scene(scene)
    script = replace(script, duration_us=min(script.duration_us, _MOST_US))
    return film_script(script, scene_config(scene), nuisances, seed=seed)


def film_script(
    script: Script,
    config: SimulatorConfig | None = None,
    nuisances: Mapping[str, float] | None = None,
    *,
    seed: int = 0,
) -> Film:
    """Films a script with 125 pictures a second.

    Args:
        script: what happens.
        config: of the simulator; its frames are made faster and shorter.
        nuisances: strength of each.
        seed: of the simulator's chance.
    """
    config = config or SimulatorConfig()
    sensor = replace(config.sensor, frame_us=PERIOD_US, exposure_us=EXPOSURE_US)
    once = replace(script, endless=False)
    with Simulator(
        once, replace(config, sensor=sensor), nuisances=nuisances or {}, seed=seed
    ) as packets:
        return Film(np.stack([frame.pixels for packet in packets for frame in packet.frames]))
