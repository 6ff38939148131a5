"""Description of a virtual device for the kernel, and the list of extra devices."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from evdev import ecodes

from neurotouch_hid.messages import GamepadState

Steps = tuple[tuple[int, int], ...]
"""EV_REL codes and how far each goes, none of them 0."""


class ExtraDevice(StrEnum):
    """The devices beside the pad; each is created only when a profile uses it."""

    KEYBOARD = "keyboard"
    MOUSE = "mouse"


def find_needed(state: GamepadState) -> set[ExtraDevice]:
    """Returns the extra devices that a state needs."""
    needed = set()
    if state.keys:
        needed.add(ExtraDevice.KEYBOARD)
    if state.mouse_buttons or state.wheel or any(state.pointer):
        needed.add(ExtraDevice.MOUSE)
    return needed


@dataclass(frozen=True, slots=True)
class Control:
    """One event code that keeps its value until it changes.

    Attributes:
        type: EV_KEY or EV_ABS.
        code: the event code.
        minimum: the smallest value it can have.
        maximum: the largest.
        rest: the value while it is not touched.
    """

    type: int
    code: int
    minimum: int
    maximum: int
    rest: int = 0


@dataclass(frozen=True, slots=True)
class DeviceSpec:
    """Description of a virtual device, for the kernel.

    Attributes:
        name: the name that programs show.
        ids: bus, vendor, product and version.
        phys: its physical path; udev rules and this program find our own nodes by it.
        controls: the controls whose values a report contains, in this order.
        motions: the EV_REL codes, which have no value but only steps.
        rumbles: games may make it shake; then a program must answer them.
    """

    name: str
    ids: tuple[int, int, int, int]
    phys: str
    controls: tuple[Control, ...]
    motions: tuple[int, ...] = ()
    rumbles: bool = False

    @property
    def neutral(self) -> tuple[int, ...]:
        """The report of a node at rest."""
        return tuple(control.rest for control in self.controls)


class VirtualDevice(Protocol):
    """One device of the kernel, at rest when it is made."""

    def write_report(self, report: tuple[int, ...], steps: Steps = (), stamp_ns: int = 0) -> None:
        """Writes the changes as one frame; nothing if nothing has changed.

        Args:
            report: the value of every control of the description, in its order.
            steps: the motions, as (code, steps).
            stamp_ns: time of the report on CLOCK_MONOTONIC; 0 is now.

        Raises:
            DeviceError: the kernel refuses it.
        """

    def close(self) -> None:
        """Removes the node."""


def make_key(code: int) -> Control:
    """Returns a key or button, down (1) or up (0)."""
    return Control(ecodes.EV_KEY, code, 0, 1)
