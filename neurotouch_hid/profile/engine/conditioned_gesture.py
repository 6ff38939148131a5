"""The gesture at one moment, made ready for the bindings."""

from dataclasses import dataclass

from neurotouch_hid.messages import Button, GestureKind
from neurotouch_hid.profile.engine.regions import Vector
from neurotouch_hid.profile.schema.conditions import Zone
from neurotouch_hid.profile.schema.targets import EightWay
from neurotouch_hid.vocabulary import Phase


@dataclass(slots=True)
class ConditionedGesture:
    """The gesture at one moment.

    Attributes:
        t_us: the moment.
        kind: the gesture; NONE at rest and while it is not clear what begins.
        mm: its intensity, in mm of the reference hand.
        way: the direction of a push, a unit vector, or None.
        four: its sector of four, or None.
        eight: its sector of eight, or None.
        zone: where on the gel the fingers were laid, or None.
        position_mm: where they are now, or None.
        contacts: how many there are.
        speed_mm_s: how fast the intensity rises.
        top_speed_mm_s: how fast it has risen at most in this gesture.
        phase: whether it rises, stays or falls.
        helper: the buttons that are held on the device that plays along.
    """

    t_us: int
    kind: GestureKind = GestureKind.NONE
    mm: float = 0.0
    way: Vector | None = None
    four: EightWay | None = None
    eight: EightWay | None = None
    zone: Zone | None = None
    position_mm: Vector | None = None
    contacts: int = 0
    speed_mm_s: float = 0.0
    top_speed_mm_s: float = 0.0
    phase: Phase = "hold"
    helper: frozenset[Button] = frozenset()
