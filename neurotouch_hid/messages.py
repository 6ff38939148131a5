"""The records that the stages exchange, with shapes and units; they exchange nothing else.

Image coordinates are pixels, origin at the top left pixel's centre, x right, y down. Gel
coordinates are millimetres in the plane the camera sees, origin at the gel's centre, x and y along
the marker lattice, x right, y down, as the user sees the gel. All stamps are signed µs of sensor
time.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TypeVar, dataclass_transform

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.geometry import PAPER_GEL, Gel
from neurotouch_hid.vocabulary import Axis, Button, GelProblem, GestureKind

__all__ = [
    "EVENT_DTYPE",
    "SENSOR_HEIGHT_PX",
    "SENSOR_WIDTH_PX",
    "Axis",
    "Button",
    "EventPacket",
    "Frame",
    "GamepadState",
    "GelProblem",
    "GelState",
    "Gesture",
    "GestureKind",
    "MarkerField",
    "RestField",
    "Step",
    "Truth",
    "no_gesture",
]

SENSOR_WIDTH_PX = 346
SENSOR_HEIGHT_PX = 260

EVENT_DTYPE = np.dtype([("t", "<i8"), ("x", "<i2"), ("y", "<i2"), ("p", "?")], align=True)
"""One event in 16 bytes, as in AEDAT4, of ``t`` in µs, ``x`` and ``y`` in px, ``p`` True for ON."""


_T = TypeVar("_T")


@dataclass_transform(frozen_default=True, eq_default=False, field_specifiers=(field,))
def _record(*, eq: bool = False, kw_only: bool = False) -> Callable[[type[_T]], type[_T]]:
    """Makes a class a frozen dataclass for type checkers, and one that is quick to make in a run.

    Python needs three times as long for one that is frozen, and a step makes five.
    """
    return dataclass(slots=True, eq=eq, kw_only=kw_only)


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One APS frame.

    Attributes:
        pixels: (260, 346) uint8, index [y, x].
        exposure_begin_us: start of the exposure.
        exposure_end_us: end of the exposure; equal to the start where a recording does not say.
    """

    pixels: NDArray[np.uint8]
    exposure_begin_us: int
    exposure_end_us: int

    @property
    def t_us(self) -> int:
        """The middle of the exposure, µs."""
        return (self.exposure_begin_us + self.exposure_end_us) // 2


@_record()
class EventPacket:
    """A slice of sensor time with everything that happened in it.

    Attributes:
        t_begin_us: first moment of the slice.
        t_end_us: first moment after the slice.
        events: (n,) EVENT_DTYPE, ascending in ``t``, all in [t_begin_us, t_end_us).
        frames: frames whose exposure ended in the slice, oldest first.
        gap: events lost since the packet before, as far as the source knows.
        is_partial: this is a partial slice; the whole slice comes next.
    """

    t_begin_us: int
    t_end_us: int
    events: NDArray[np.void]
    frames: tuple[Frame, ...] = ()
    gap: int = 0
    is_partial: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class RestField:
    """Positions of all markers in a frame that shows the gel at rest.

    Attributes:
        t_us: the moment of the frame (middle of its exposure).
        position_px: (n, 2) float32, columns x, y, in the order of ``Gel.points_mm``.
        is_new: True if earlier rest positions were wrong.
        blur_px: standard deviation of the point spread if the lens is out of focus, else 0.
    """

    t_us: int
    position_px: NDArray[np.float32]
    is_new: bool = False
    blur_px: float = 0.0


@_record(eq=True, kw_only=True)
class GelState:
    """The gel as the camera sees it; a new object only when something has changed.

    Attributes:
        layout: the gel as it was made.
        is_found: the places of the markers at rest are known, so gestures count.
        was_found: they have been known before; without ``is_found`` the gel is lost.
        problem: the problem. A gel that is found may have one too.
        n_seen: markers seen at their places; all bright dots, if they form no lattice.
        missing: markers that are not seen, as places in ``Gel.points_mm``; empty if the places of
            the markers are unknown.
        missing_px: where they should be in the image, (x, y) px each.
        px_per_mm: scale of the image; None if it is unknown, as are the next four.
        rotation_deg: turn of the lattice in the image, clockwise, with ``is_found`` only.
        bend_px: largest deviation of the markers from a smooth lattice.
        scatter_px: how far single markers are off that lattice, standard deviation.
        blur_px: width of the point spread, standard deviation.
        flicker_hz: frequency at which the light flickers; None if it is steady.
        n_glints: bright spots among the markers that are none.
        moved_mm: how far the gel is from where it was found first.
    """

    layout: Gel = field(default=PAPER_GEL, repr=False)
    is_found: bool = False
    was_found: bool = False
    problem: GelProblem = GelProblem.WAITING
    n_seen: int = 0
    missing: tuple[int, ...] = ()
    missing_px: tuple[tuple[float, float], ...] = ()
    px_per_mm: float | None = None
    rotation_deg: float | None = None
    bend_px: float | None = None
    scatter_px: float | None = None
    blur_px: float | None = None
    flicker_hz: float | None = None
    n_glints: int = 0
    moved_mm: float = 0.0


@_record()
class MarkerField:
    """All markers at one moment, in the order of ``Gel.points_mm``.

    Attributes:
        t_us: the end of the slice.
        rest_px: (n, 2) float32, columns x, y: where each marker is while the gel is
            undeformed. The same array object until it changes; all NaN before the gel is found.
        position_px: (n, 2) float32: where each marker is now.
        valid: (n,) bool: the position is measured, not a guess from the neighbours.
        gel: the gel with these markers.
    """

    t_us: int
    rest_px: NDArray[np.float32]
    position_px: NDArray[np.float32]
    valid: NDArray[np.bool_]
    gel: Gel = PAPER_GEL


@_record()
class Gesture:
    """The gesture at one moment.

    Attributes:
        t_us: the moment.
        kind: the type; NONE at rest.
        contacts_mm: (K, 2) float64, gel coordinates of the contact points, columns x, y.
        contacts_px: (K, 2) float64, the same points in the image.
        intensity_mm: mean displacement of the gel around the contacts, >= 0.
        translation_mm: the common motion (x, y) of the markers around the contacts since rest.
        rotation_rad: their rotation about the mean contact, clockwise for the user is positive.
        scale: their scaling about the mean contact, 1 at rest, below 1 for a pinch.
        confidence: 0..1.
    """

    t_us: int
    kind: GestureKind
    contacts_mm: NDArray[np.float64]
    contacts_px: NDArray[np.float64]
    intensity_mm: float
    translation_mm: tuple[float, float] = (0.0, 0.0)
    rotation_rad: float = 0.0
    scale: float = 1.0
    confidence: float = 1.0


_NO_POINTS = np.zeros((0, 2))


def no_gesture(t_us: int, confidence: float = 1.0) -> Gesture:
    """Returns a record without a gesture at ``t_us``."""
    return Gesture(t_us, GestureKind.NONE, _NO_POINTS, _NO_POINTS, 0.0, confidence=confidence)


@_record(eq=True)
class GamepadState:
    """The wanted state of all outputs at one moment: the whole pad, keyboard and mouse.

    Attributes:
        t_us: the moment.
        buttons: the buttons that are down.
        axes: axis values; an axis that is not named is at rest (0).
        keys: the keyboard keys that are down, by the kernel's names (``KEY_LEFTCTRL``).
        mouse_buttons: the mouse buttons that are down, by the kernel's names (``BTN_LEFT``).
        pointer: how fast the mouse moves, (x, y) in px/s, right and down positive.
        wheel: how fast the wheel turns, in clicks per second, up (away) positive.
        commands: commands to the program itself at this moment, once each: ``pause``,
            ``resume``, ``panic``, ``rezero``, ``next_profile``.
    """

    t_us: int
    buttons: frozenset[Button] = frozenset()
    axes: Mapping[Axis, float] = field(default_factory=dict)
    keys: frozenset[str] = frozenset()
    mouse_buttons: frozenset[str] = frozenset()
    pointer: tuple[float, float] = (0.0, 0.0)
    wheel: float = 0.0
    commands: tuple[str, ...] = ()

    @property
    def is_neutral(self) -> bool:
        """True if nothing is pressed and nothing moves; commands are no output."""
        return not (
            self.buttons
            or self.keys
            or self.mouse_buttons
            or self.wheel
            or any(self.pointer)
            or any(self.axes.values())
        )


@_record()
class Truth:
    """The true gesture at one moment, from the simulator or from a data set's label.

    Attributes:
        t_us: the moment.
        kind: the gesture type.
        contacts_px: (K, 2) float64, image points of the contacts, columns x, y.
        intensity_mm: mean displacement of the contact points since the gesture began.
        markers_px: (n, 2) float32, true marker positions, or None where they are unknown.
    """

    t_us: int
    kind: GestureKind
    contacts_px: NDArray[np.float64]
    intensity_mm: float
    markers_px: NDArray[np.float32] | None = None


@_record()
class Step:
    """One step of the pipeline: its packet and the result of each stage.

    It contains no host time, so that two runs can be compared bit by bit. ``rest`` is the anchor
    taken in this step, or None. ``gel`` is what the frames so far show of the gel.
    """

    packet: EventPacket
    rest: RestField | None
    markers: MarkerField
    gesture: Gesture
    pad: GamepadState
    gel: GelState
