"""Reads the running driver for other programs."""

import select
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.driver_state import read_head, read_markers
from neurotouch_hid.subscriber import Subscriber
from neurotouch_hid.vocabulary import Axis, Button

LOOK_S: Final = 0.25
"""Interval at which a driver is looked for while none runs."""


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """The gesture, the pad and the markers at one moment; as made without values, all at rest.

    Attributes:
        t_us: the moment in µs of sensor time.
        state: ``running``, ``paused`` or ``panic``; ``ended`` while no driver runs.
        simulated: no sensor has seen it.
        kind: ``none``, ``push``, ``pinch``, ``zoom``, ``twist_cw`` or ``twist_ccw``.
        intensity_mm: how far the gel is dragged around the contacts.
        confidence: 0 to 1.
        movement: the movement for the bindings: ``push_left``, ``pinch``, ``none``.
        moved_mm: (x, y), the common motion of the markers around the contacts; x right, y towards
            the user.
        turned_rad: their rotation, clockwise positive.
        scale: their scaling, 1 at rest.
        contacts_mm: the contact points (x, y) from the centre of the gel.
        axes: all axes of the pad: -1 to 1, triggers 0 to 1.
        buttons: all buttons of the pad, and whether they are down.
        markers_mm: (n, 2) float32, how far each marker is from its rest; n is 0 while no driver
            runs.
    """

    t_us: int = 0
    state: str = "ended"
    simulated: bool = False
    kind: str = "none"
    intensity_mm: float = 0.0
    confidence: float = 0.0
    movement: str = "none"
    moved_mm: tuple[float, float] = (0.0, 0.0)
    turned_rad: float = 0.0
    scale: float = 1.0
    contacts_mm: tuple[tuple[float, float], ...] = ()
    axes: dict[str, float] = field(default_factory=lambda: dict.fromkeys(map(str, Axis), 0.0))
    buttons: dict[str, bool] = field(default_factory=lambda: dict.fromkeys(map(str, Button), False))
    markers_mm: NDArray[np.float32] = field(default_factory=lambda: np.zeros((0, 2), np.float32))


def read_states(hz: int, end_s: float) -> Iterator[Reading]:
    """Yields the newest state of the running driver whenever there is one.

    Without a driver it waits for one. When a driver ends, all at rest is yielded, once.

    Args:
        hz: states a second, 60 at most.
        end_s: when to end, in seconds of ``time.monotonic``.
    """
    with Subscriber() as subscriber:
        subscriber.want(hz)
        yield Reading()
        while (left_s := end_s - time.monotonic()) > 0.0:
            if (peer := subscriber.connect()) is None:
                time.sleep(min(LOOK_S, left_s))
                continue
            select.select([peer], [], [], min(left_s, 1.0))
            state = subscriber.take()
            if state is not None:
                yield _read(state)
            if subscriber.peer is None:
                yield Reading()


def _read(state: bytes) -> Reading:
    head = read_head(state)
    gesture, pad, at_rest = head["gesture"], head["pad"], Reading()
    x_mm, y_mm = gesture["moved_mm"]
    return Reading(
        t_us=head["t_us"],
        state=head["state"],
        simulated=head["slow"]["simulated"],
        kind=gesture["kind"],
        intensity_mm=gesture["mm"],
        confidence=gesture["confidence"],
        movement=gesture["movement"],
        moved_mm=(x_mm, y_mm),
        turned_rad=gesture["turned_rad"],
        scale=gesture["scale"],
        contacts_mm=tuple((x, y) for x, y in gesture["contacts"]),
        axes=at_rest.axes | pad["axes"],
        buttons=at_rest.buttons | dict.fromkeys(pad["buttons"], True),
        markers_mm=read_markers(state)[0],
    )
