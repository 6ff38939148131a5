"""Interface for programs: opens a source and reads gestures."""

import select
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final, Self

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.client import explain_absence
from neurotouch_hid.closing import Closing
from neurotouch_hid.driver import DriverOptions
from neurotouch_hid.driver_state import MarkerWriter, PadState, read_head, read_markers
from neurotouch_hid.errors import NeuroTouchError, NotRunningError, require_type
from neurotouch_hid.messages import Axis, Button, Frame, GamepadState
from neurotouch_hid.subscriber import Subscriber
from neurotouch_hid.vocabulary import RUNNING_DRIVER, Speed

if TYPE_CHECKING:
    from neurotouch_hid.driver import Driver
    from neurotouch_hid.messages import Step

_HZ: Final = 60
"""States a second requested from a running driver; this is its highest rate."""


@dataclass(frozen=True, slots=True, eq=False)
class Touch:
    """The gesture, the pad and the gel at one moment.

    Attributes:
        t_us: the moment, in µs of sensor time.
        kind: ``none``, ``push``, ``pinch``, ``zoom``, ``twist_cw`` or ``twist_ccw``.
        intensity_mm: how far the gel is dragged around the contacts, in mm.
        contacts_mm: (K, 2) float64, the contact points, columns x, y, in mm from the centre of the
            gel; x right, y towards the user.
        translation_mm: (x, y), the common motion of the gel around the contacts, in mm.
        rotation_rad: the rotation of the gel around the contacts, clockwise positive.
        scale: its scaling, 1 at rest, below 1 for a pinch.
        confidence: 0 to 1.
        pad: the state of the virtual gamepad.
        markers_mm: (n, 2) float32, how far each marker is from its rest, columns x, y, in mm.
        measured: (n,) bool, True where a marker is measured, False where it is a guess.
        events: (n,) of ``EVENT_DTYPE``, the events of the slice; None of a running driver.
        frames: the frames of the slice; empty of a running driver.
    """

    t_us: int
    kind: str
    intensity_mm: float
    contacts_mm: NDArray[np.float64]
    translation_mm: tuple[float, float]
    rotation_rad: float
    scale: float
    confidence: float
    pad: GamepadState
    markers_mm: NDArray[np.float32] = field(repr=False)
    measured: NDArray[np.bool_] = field(repr=False)
    events: NDArray[np.void] | None = field(default=None, repr=False)
    frames: tuple[Frame, ...] = field(default=(), repr=False)


class Gel(Closing):
    """An open gel: iterate over it for one ``Touch`` after the other; a context manager."""

    name: str
    """The source as a person writes it."""

    def __init__(self, touches: Iterator[Touch], owner: Closing, name: str) -> None:
        self.name = name
        self._touches = touches
        self._owner: Closing | None = owner

    def __iter__(self) -> Iterator[Touch]:
        """Yields each touch as it arrives.

        Raises:
            NeuroTouchError: the gel is closed, or the source fails.
        """
        while True:
            self._require_open()
            try:
                touch = next(self._touches, None)
            except NeuroTouchError:
                self._require_open()  # another thread may have closed it meanwhile
                raise
            if touch is None:
                return
            yield touch

    def __enter__(self) -> Self:
        """Returns the gel itself.

        Raises:
            NeuroTouchError: it is closed.
        """
        self._require_open()
        return self

    def close(self) -> None:
        """Closes the source; a second call does nothing."""
        owner, self._owner = self._owner, None
        if owner is not None:
            owner.close()

    def _require_open(self) -> None:
        if self._owner is None:
            raise NeuroTouchError(
                "The gel is closed.",
                hint="Read it inside the block: with open_gel(...) as gel: for touch in gel: ...",
            )


def open_gel(
    source: str | Path = "davis:",
    *,
    profile: str | Path = "default",
    method: str = "neurotouch",
    gel: str | Path | None = None,
    speed: Speed = "recorded",
    rate_hz: float | None = None,
    seed: int = 0,
    player: int = 1,
    personal: bool = False,
) -> Gel:
    """Opens a gel.

    Args:
        source: ``davis:`` (the camera), ``file:NAME.aedat4``, ``file:NAME.mkv`` or a ``Path`` (a
            recording or video clip),
            ``sim:NAME``, a source of a plug-in, or ``driver:``, the running driver. Reading a
            driver does not affect it; a slow reader misses states and always gets the newest. The
            other options do not apply to it, except ``player``.
        profile: name or path of the profile that makes ``Touch.pad``.
        method: the recogniser.
        gel: name or path of the gel's file; None means the one of the recording or of the person,
            ``paper`` the gel of the paper.
        speed: ``recorded`` plays as recorded, ``max`` as fast as possible.
        rate_hz: slices a second, 25 to 1000; None means the usual rate of the source.
        seed: the seed of the simulation, 0 or more.
        player: the player number, 1 to 4.
        personal: the person's own range, filter and resting hand apply, as in a game.

    Raises:
        TypeError: an argument has the wrong type.
        ValueError: an argument has an impossible value.
        NotRunningError: ``driver:`` was asked for, and none runs.
        NeuroTouchError: the source, the profile or the method cannot be used.
    """
    require_type("profile", profile, (str, Path), "a name or path such as 'spacecraft'")
    options = DriverOptions(
        source=f"file:{source}" if isinstance(source, Path) else source,
        profile=f"{Path.cwd() / profile}" if isinstance(profile, Path) else profile,
        device="memory",
        player=player,
        speed=speed,
        rate_hz=rate_hz,
        method=method,
        gel=f"{gel}" if isinstance(gel, Path) else gel,
        seed=seed,
        personal=personal,
        listens=False,
    )
    if options.source == RUNNING_DRIVER:
        subscriber = Subscriber(player)
        subscriber.want(_HZ)
        if subscriber.connect() is None:
            raise NotRunningError("No driver is running.", hint=explain_absence(player))
        return Gel(_read_driver(subscriber), subscriber, options.source)
    from neurotouch_hid.driver import Driver  # noqa: PLC0415  # needs numba

    driver = Driver(options)
    driver.__enter__()
    return Gel(_read_steps(driver), driver, driver.source.name)


def _read_steps(driver: "Driver") -> Iterator[Touch]:
    markers = MarkerWriter()
    for step in driver.steps():
        yield _from_step(step, markers)


def _from_step(step: "Step", markers: MarkerWriter) -> Touch:
    gesture = step.gesture
    return Touch(
        gesture.t_us,
        gesture.kind.label,
        gesture.intensity_mm,
        gesture.contacts_mm,
        gesture.translation_mm,
        gesture.rotation_rad,
        gesture.scale,
        gesture.confidence,
        step.pad,
        markers.measure(step.markers),
        step.markers.valid,
        step.packet.events,
        step.packet.frames,
    )


def _read_driver(subscriber: Subscriber) -> Iterator[Touch]:
    """Yields the newest state whenever there is one, until the driver ends."""
    while subscriber.peer is not None:
        select.select([subscriber.peer], [], [])
        state = subscriber.take()
        if state is not None:
            yield _from_state(state)


def _from_state(state: bytes) -> Touch:
    head = read_head(state)
    gesture = head["gesture"]
    x_mm, y_mm = gesture["moved_mm"]
    moved_mm, measured = read_markers(state)
    return Touch(
        head["t_us"],
        gesture["kind"],
        gesture["mm"],
        np.array(gesture["contacts"], np.float64).reshape(-1, 2),
        (x_mm, y_mm),
        gesture["turned_rad"],
        gesture["scale"],
        gesture["confidence"],
        _read_pad(head["t_us"], head["pad"]),
        moved_mm,
        measured,
    )


def _read_pad(t_us: int, pad: PadState) -> GamepadState:
    x, y = pad["pointer"]
    return GamepadState(
        t_us,
        frozenset(map(Button, pad["buttons"])),
        {Axis(name): value for name, value in pad["axes"].items()},
        frozenset(pad["keys"]),
        frozenset(pad["mouse"]),
        (x, y),
        pad["wheel"],
    )
