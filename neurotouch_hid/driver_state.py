"""The newest state of the pipeline as bytes: a head of JSON, then all markers.

4 bytes   length of the head, little-endian
4 bytes   number of markers n, little-endian, at most 400
head      UTF-8 JSON, see ``State``
4 n bytes int16 (n, 2): place of each marker on the gel at rest, x and y, in 0.01 mm
4 n bytes int16 (n, 2): how far it is from there, x and y, in 0.01 mm
n bytes   uint8: 1 where it is measured, 0 where it is a guess
"""

import json
from typing import Final, NotRequired, TypedDict

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import DriverError
from neurotouch_hid.geometry import MOST_MARKERS, Gel, fit_rig
from neurotouch_hid.messages import MarkerField
from neurotouch_hid.status import GelFacts, PadFacts, RumbleState
from neurotouch_hid.vocabulary import Phase, PipelineState

STEP_MM: Final = 0.01
_BEGIN: Final = 8
_MARKER_BYTES: Final = 9

_encode: Final = json.JSONEncoder(separators=(",", ":"), ensure_ascii=False).encode

Action = tuple[int, str, str, str]
"""A decision of the mapping: time (µs of sensor time), verdict, binding, and reason."""


class GestureState(TypedDict):
    """The recognised gesture, and the conditioned gesture that the bindings use.

    Attributes:
        kind: its type, ``none`` at rest.
        mm: intensity.
        movement: the movement for the bindings: ``push_left``, ``pinch``, ``none``.
        felt_mm: its intensity after the tremor filter.
        phase: whether the intensity rises, stays or falls; ``hold`` at rest.
        contacts: contact points [x, y] in mm.
        confidence: 0 to 1.
        moved_mm: the common motion [x, y] of the markers around the contacts.
        turned_rad: their rotation, clockwise positive.
        scale: their scaling.
    """

    kind: str
    mm: float
    movement: str
    felt_mm: float
    phase: Phase
    contacts: list[list[float]]
    confidence: float
    moved_mm: list[float]
    turned_rad: float
    scale: float


class PadState(TypedDict):
    """All outputs; axes at rest are left out.

    Attributes:
        axes: -1 to 1, triggers 0 to 1.
        buttons: those that are down.
        keys: keyboard keys that are down.
        mouse: mouse buttons that are down.
        pointer: [x, y] in px/s.
        wheel: in clicks per second.
    """

    axes: dict[str, float]
    buttons: list[str]
    keys: list[str]
    mouse: list[str]
    pointer: list[float]
    wheel: float


class SourceFacts(TypedDict, total=False):
    """Facts that only some sources know.

    Attributes:
        hand_ms: median and 95 % from the mouse to the pad in ms; of the mouse gel only.
        backlog_ms: how late the newest slice was begun, where the source knows better.
    """

    hand_ms: list[float] | None
    backlog_ms: float


class Facts(PadFacts):
    """Facts about what surrounds the pipeline.

    Attributes:
        source: the source.
        simulated: no sensor has seen it.
        device: the virtual gamepad.
        file: the file of the active profile, empty if it has gone.
        plays_sound: whether the driver plays sounds itself; a service cannot.
    """

    source: str
    simulated: bool
    device: str
    file: str
    plays_sound: bool


class Health(TypedDict):
    """Facts, rates and times, updated twice a second.

    Attributes:
        events_hz: events per second, mean of the last second.
        slices_hz: slices per second.
        frames_hz: frames per second.
        lost: events lost since the start.
        backlog_ms: how long a slice waits before the pipeline.
        tracked: markers that are measured.
        rezero_s: how long ago the gel was seen at rest; None before the first time.
        window_ms: length of a slice.
        stages: median and 95 % of the host time a slice in ms, by stage.
        source: the source.
        simulated: the source is a simulation.
        device: the virtual gamepad.
        file: the file of the active profile, empty if it has gone.
        accept_ms: time before a gesture acts, from the profile and the person's values.
        plays_sound: whether the driver plays sounds itself; a service cannot.
        copilot: the physical device that plays along.
        mouse: the mice that are watched.
        rumble: the rumble that games request.
        hand_ms: median and 95 % from the mouse to the pad in ms; of the mouse gel only.
    """

    events_hz: int
    slices_hz: int
    frames_hz: float
    lost: int
    backlog_ms: float
    tracked: int
    rezero_s: float | None
    window_ms: float
    stages: dict[str, list[float]]
    source: str
    simulated: bool
    device: str
    file: str
    accept_ms: NotRequired[float]
    plays_sound: NotRequired[bool]
    copilot: NotRequired[str]
    mouse: NotRequired[str]
    rumble: NotRequired[RumbleState]
    hand_ms: NotRequired[list[float] | None]


class State(TypedDict):
    """The state without the markers.

    Attributes:
        n: counts up.
        t_us: the moment, in sensor time.
        say: the sentence for people.
        state: ``running``, ``paused`` or ``panic``.
        profile: the active profile.
        layer: its active layer.
        gel: the gel as the camera sees it.
        gesture: the gesture.
        pad: the outputs.
        actions: the latest decisions, oldest first.
        slow: facts, rates and times.
    """

    n: int
    t_us: int
    say: str
    state: PipelineState
    profile: str
    layer: str
    gel: GelFacts
    gesture: GestureState
    pad: PadState
    actions: list[Action]
    slow: Health


class MarkerWriter:
    """Encodes marker displacements; fits the rig again only when the rest position has changed."""

    def __init__(self) -> None:
        self._gel: Gel | None = None
        self._places = b""
        self._rest_px: NDArray[np.float32] | None = None
        self._to_steps: np.complex64 | None = None

    def write(self, markers: MarkerField) -> bytes:
        """Returns places, displacements and flags of all markers.

        Displacements and flags are zeros while no gel has been found.
        """
        if self._gel is not markers.gel:
            self._gel = markers.gel
            self._places = np.rint(self._gel.points_mm / STEP_MM).astype(np.int16).tobytes()
        steps = self._find_moved(markers)
        if steps is None:
            return self._places + bytes(5 * self._gel.n_markers)
        return self._places + steps.astype(np.int16).tobytes() + markers.valid.tobytes()

    def measure(self, markers: MarkerField) -> NDArray[np.float32]:
        """Returns how far each marker is from its rest: (n, 2) float32, mm; zeros if unknown."""
        steps = self._find_moved(markers)
        if steps is None:
            return np.zeros(markers.rest_px.shape, np.float32)
        return steps * np.float32(STEP_MM)

    def _find_moved(self, markers: MarkerField) -> NDArray[np.float32] | None:
        if markers.rest_px is not self._rest_px:
            self._rest_px = markers.rest_px
            self._to_steps = _find_steps(markers.rest_px, markers.gel)
        if self._to_steps is None:
            return None
        moved_px = (markers.position_px - markers.rest_px).view(np.complex64)
        return (moved_px * self._to_steps).view(np.float32)


def _find_steps(rest_px: NDArray[np.float32], gel: Gel) -> np.complex64 | None:
    """Returns what turns and scales displacements x + iy in pixels to steps.

    None while they are unknown.

    One product of complex numbers replaces a product of matrices: at thirty calls a second, the
    large library for matrices would be out of the caches each time.
    """
    if not np.isfinite(rest_px).all():
        return None
    x, y = fit_rig(rest_px, gel).vector_to_mm(np.array([[1.0, 0.0]]))[0] / STEP_MM
    return np.complex64(complex(x, y))


def pack(state: State, markers: bytes) -> bytes:
    """Returns the bytes of a state; ``markers`` as of ``MarkerWriter.write``."""
    head = _encode(state).encode()
    n = len(markers) // _MARKER_BYTES
    return len(head).to_bytes(4, "little") + n.to_bytes(4, "little") + head + markers


def read_head(state: bytes) -> State:
    """Returns the head of a state.

    Raises:
        DriverError: this is no state of this version.
    """
    begin, _ = _find_markers(state)
    head: State = json.loads(state[_BEGIN:begin])
    return head


def read_markers(state: bytes) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Returns the markers of a state.

    Returns:
        (n, 2) float32, how far each marker is from its rest, columns x, y, in mm; and (n,) bool,
        True where the marker is measured.

    Raises:
        DriverError: this is no state of this version.
    """
    begin, n = _find_markers(state)
    steps = np.frombuffer(state, np.int16, 2 * n, begin + 4 * n).reshape(-1, 2)
    valid = np.frombuffer(state, np.bool_, n, begin + 8 * n)
    return steps * np.float32(STEP_MM), valid


def _find_markers(state: bytes) -> tuple[int, int]:
    """Returns where the markers begin, and their number."""
    begin = _BEGIN + int.from_bytes(state[:4], "little")
    n = int.from_bytes(state[4:_BEGIN], "little")
    if not 0 < n <= MOST_MARKERS or len(state) != begin + _MARKER_BYTES * n:
        raise DriverError(
            "The driver's state has an unknown form.",
            hint="The driver may be of another version than this program: start it again.",
        )
    return begin, n
