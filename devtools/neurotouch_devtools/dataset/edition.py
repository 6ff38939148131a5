"""The parts of the public data set: people, gels, cameras, rooms, and the seed of each.

A change here, or of the simulator, is a new edition: raise ``EDITION`` and write its checksums.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from neurotouch_hid.source.simulator.dataset import KINDS
from neurotouch_hid.source.simulator.gel import Elasticity

EDITION: Final = 1

SPLITS: Final = {"open": 800_000, "judge": 900_000}
"""Below the first seed of each split. Nobody looks at those of ``judge``: 901,000 to 909,999."""

SEEDS_OF_AN_EDITION: Final = 1000


@dataclass(frozen=True, slots=True)
class Part:
    """One folder of recordings: simulated people, each of whom makes all five gestures.

    Attributes:
        folder: inside of the data set.
        what: gel, camera and room in words.
        seed: of people and gestures.
        users: number of people.
        seconds: length of each recording.
        elasticity: model of the gel.
        nuisances: strength of each nuisance, by its name.
        gel: name of a file of the folder ``gels``; empty for the dots of the paper.
    """

    folder: str
    what: str
    seed: int
    users: int = 1
    seconds: float = 3.0
    elasticity: Elasticity = "half-space"
    nuisances: Mapping[str, float] = field(default_factory=dict)
    gel: str = ""

    @property
    def minutes(self) -> float:
        """Length of all its recordings."""
        return self.seconds * self.users * len(KINDS) / 60.0


_ROOM: Final = {
    "missing": 2.0, "faint": 2.0, "irregular": 10.0, "residue": 1.0, "bump": 0.3, "tilt": 3.0,
    "lens": -3.0, "blur": 0.9, "uneven": 60.0, "shadow": 15.0, "glints": 3.0, "dust": 10.0,
    "gel-dust": 6.0, "frame-noise": 4.0, "hot": 20.0, "noise": 3.0,
}  # fmt: skip
"""A room whose light does not flicker: to simulate that takes ten times as long."""

_WEBCAM: Final = {"uvc": 60.0, "rolling": 12.0, "gamma": 2.2, "mjpeg": 70.0}

_KINDS_OF_PARTS: Final[tuple[tuple[str, str, Elasticity, Mapping[str, float], str], ...]] = (
    ("davis", "event camera, gel of closed forms", "half-space", {}, ""),
    ("davis-solid", "event camera, gel of finite elements", "solid", {}, ""),
    ("davis-few-frames", "the same with 4 frames/s instead of 25", "solid", {"frames": 4.0}, ""),
    ("davis-room", "event camera in a room with 16 nuisances", "solid", _ROOM, ""),
    ("davis-hex", "event camera, 151 dots in a hexagonal lattice", "half-space", {}, "hex"),
    ("webcam", "60 frames/s, rolling shutter, JPEG at quality 70", "solid", _WEBCAM, ""),
    ("webcam-rings", "125 frames/s, 127 dots on rings", "half-space", {"uvc": 125.0}, "rings"),
)


def list_parts(split: str, edition: int = EDITION) -> tuple[Part, ...]:
    """Returns the parts of ``open`` or ``judge``; no two parts share people or gestures."""
    first = SPLITS[split] + SEEDS_OF_AN_EDITION * edition
    return tuple(
        Part(
            f"{split}/{name}", what, first + k,
            elasticity=elasticity, nuisances=nuisances, gel=gel,
        )
        for k, (name, what, elasticity, nuisances, gel) in enumerate(_KINDS_OF_PARTS, 1)
    )  # fmt: skip
