"""What the camera sees: pictures at a fixed rate, prepared before it is plugged in."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.source.simulator import find_scene, scene_config
from neurotouch_hid.source.simulator.scenes import read_simulation

PERIOD_US = 8_000
EXPOSURE_US = 4_000
_MOST_US = 30_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Film:
    """Grey pictures, again from the first when the last is over.

    Attributes:
        pictures: (n, h, w) uint8.
        period_us: time from one to the next.
    """

    pictures: NDArray[np.uint8]
    period_us: int = PERIOD_US

    def find(self, t_us: int) -> NDArray[np.uint8]:
        """Returns the picture at a time since its begin: (h, w) uint8."""
        picture: NDArray[np.uint8] = self.pictures[t_us // self.period_us % len(self.pictures)]
        return picture


def film_scene(name: str, seconds: float | None = None, *, seed: int = 0) -> Film:
    """Films a scene of the simulator with 125 pictures a second.

    Args:
        name: ``NAME[,NUISANCE[=STRENGTH]]...``.
        seconds: length; that of the scene if None, but at most 30 s.
        seed: of the simulator's chance.

    Raises:
        SourceError: there is no such scene or nuisance.
    """
    from neurotouch_hid.source.simulator import Simulator  # noqa: PLC0415 - compiles

    scene, nuisances = read_simulation(name)
    script, config = find_scene(scene), scene_config(scene)
    length_us = min(script.duration_us, _MOST_US) if seconds is None else int(1e6 * seconds)
    sensor = replace(config.sensor, frame_us=PERIOD_US, exposure_us=EXPOSURE_US)
    pictures = []
    with Simulator(
        replace(script, endless=True),
        replace(config, sensor=sensor),
        nuisances=nuisances,
        seed=seed,
    ) as packets:
        for packet in packets:
            pictures += [frame.pixels for frame in packet.frames]
            if packet.t_end_us >= length_us:
                break
    return Film(np.stack(pictures))
