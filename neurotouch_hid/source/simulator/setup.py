"""The set-up of one simulation: script, settings, and the nuisances that act on them."""

import zlib
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import SourceError
from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.messages import Frame
from neurotouch_hid.source.simulator.config import SimulatorConfig
from neurotouch_hid.source.simulator.knot import Dots, Knot, Pose, make_dots
from neurotouch_hid.source.simulator.script import Play, Script, Stroke

USUAL_US = 15_000_000
"""The length of a play that has none, such as a hand that follows a mouse."""

Mount = Callable[[int], Pose]
"""Returns how the gel has moved in its mount at a time in µs."""

Marks = Callable[[int, Knot, Knot], NDArray[np.float64]]
"""Returns what else is in the picture: (k, 6), rows as of ``CameraModel.outline``; always as many.

It is called with the time in µs, the gel now and the gel untouched.
"""

Lamp = Callable[[NDArray[np.float64]], tuple[NDArray[np.float64], NDArray[np.float64]]]
"""Returns, at each time in µs, the share of the usual light and the light that comes through the
gel, in white markers."""

Shade = Callable[[int, Knot], NDArray[np.float32]]
"""Returns the share of the light that reaches each pixel, (260 * 346,), at a time in µs."""

Wire = Callable[["Piece"], "Piece"]
"""Changes what the sensor sends."""


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """Output of the sensor in a few ms.

    Attributes:
        begin_us: start of the time.
        end_us: its end.
        events: (n,) EVENT_DTYPE, ascending in time.
        frames: whose exposure ends in the time.
        picture_dn: (260, 346) float32, the picture at the end.
    """

    begin_us: int
    end_us: int
    events: NDArray[np.void]
    frames: tuple[Frame, ...]
    picture_dn: NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class ClockChange:
    """Something that happens to the camera's clock.

    Attributes:
        at_us: when, in time of the simulation.
        lost_us: for how long nothing arrives from then on.
        shift_us: by how much all later stamps are larger.
    """

    at_us: int
    lost_us: int = 0
    shift_us: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class Setup:
    """One simulation. A nuisance is a function that returns a changed one.

    Attributes:
        script: the fingers' motion.
        config: gel, camera, pixels, light.
        seed: of all that is random.
        dots: the markers as they were made.
        mount: motions of the gel in its mount, which add up.
        marks: other things in the picture.
        lamps: light that changes over time; gains multiply, leaks add up.
        shades: light that changes over the picture; they multiply.
        wires: changes of events and frames, one after another.
        clock: changes of the clock.
    """

    script: Play
    config: SimulatorConfig
    seed: int
    dots: Dots = field(default_factory=lambda: make_dots(PAPER_GEL))
    mount: tuple[Mount, ...] = ()
    marks: tuple[Marks, ...] = ()
    lamps: tuple[Lamp, ...] = ()
    shades: tuple[Shade, ...] = ()
    wires: tuple[Wire, ...] = ()
    clock: tuple[ClockChange, ...] = ()

    def plus(self, **more: Any) -> "Setup":
        """Returns the set-up with one thing more, by the name of its attribute."""
        changed: dict[str, Any] = {
            name: (*getattr(self, name), thing) for name, thing in more.items()
        }
        return replace(self, **changed)

    def configured(self, part: str, **values: Any) -> "Setup":
        """Returns the set-up with other values in one part of its configuration."""
        changed = replace(getattr(self.config, part), **values)
        return replace(self, config=replace(self.config, **{part: changed}))

    def random(self, name: str) -> np.random.Generator:
        """Returns random numbers that depend on the seed and this name only."""
        return np.random.default_rng((self.seed, 4, zlib.crc32(name.encode())))

    @property
    def duration_us(self) -> int:
        """Length of the play; an endless one counts once."""
        return max(self.script.duration_us, USUAL_US if self.script.endless else 0)

    @property
    def strokes(self) -> tuple[Stroke, ...]:
        """The gestures of the script, one after another.

        Raises:
            SourceError: a hand plays without a script.
        """
        strokes: tuple[Stroke, ...] | None = getattr(self.script, "strokes", None)
        if strokes is None:
            raise _refuse_hand()
        return strokes

    @property
    def written(self) -> Script:
        """The script, so that its gestures can be changed.

        Raises:
            SourceError: a hand plays without a script.
        """
        if not isinstance(self.script, Script):
            raise _refuse_hand()
        return self.script


def _refuse_hand() -> SourceError:
    return SourceError(
        "This nuisance needs gestures that are known before, and here a hand plays freely.",
        hint="Use a scene, for example sim:tour.",
    )
