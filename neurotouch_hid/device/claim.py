"""What a node of the kernel claims to be, and which nodes there are."""

from dataclasses import dataclass
from enum import StrEnum

from evdev import ecodes

from neurotouch_hid.messages import GamepadState

Steps = tuple[tuple[int, int], ...]
"""EV_REL codes and how far each goes, none of them 0."""


class Companion(StrEnum):
    """The nodes that may stand beside the pad; each is made only when a profile uses it."""

    KEYBOARD = "keyboard"
    MOUSE = "mouse"


def find_needed(state: GamepadState) -> set[Companion]:
    """Return the companions that a state cannot be shown without."""
    needed = set()
    if state.keys:
        needed.add(Companion.KEYBOARD)
    if state.mouse_buttons or state.wheel or any(state.pointer):
        needed.add(Companion.MOUSE)
    return needed


@dataclass(frozen=True, slots=True)
class Control:
    """One event code that keeps its value until it changes. At rest the value is 0.

    Attributes:
        type: EV_KEY or EV_ABS.
        code: the event code.
        minimum: the smallest value it can have.
        maximum: the largest.
    """

    type: int
    code: int
    minimum: int
    maximum: int


@dataclass(frozen=True, slots=True)
class Claim:
    """All that the kernel is told when a node is made.

    Attributes:
        name: what programs show.
        ids: bus, vendor, product and version.
        phys: where it claims to be plugged in; udev rules and we find our own nodes by it.
        controls: what a report gives the values of, in this order.
        motions: the EV_REL codes, which have no value but only steps.
    """

    name: str
    ids: tuple[int, int, int, int]
    phys: str
    controls: tuple[Control, ...]
    motions: tuple[int, ...] = ()

    @property
    def neutral(self) -> tuple[int, ...]:
        """The report of a node that nobody touches."""
        return (0,) * len(self.controls)


def make_key(code: int) -> Control:
    """A key or button, down (1) or up (0)."""
    return Control(ecodes.EV_KEY, code, 0, 1)
