"""A device in memory only: it records the states written, for tests and dry runs."""

from collections import Counter, deque
from collections.abc import Iterable
from threading import Lock

from neurotouch_hid.closing import Closing
from neurotouch_hid.device.outputs import keyboard, mouse
from neurotouch_hid.device.outputs.identity import load_identities
from neurotouch_hid.device.outputs.spec import ExtraDevice, find_needed
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import GamepadState

_Report = tuple[int, ...]

_LAYOUT = load_identities()["xbox360"].layout


class MemoryDevice(Closing):
    """Records the states that real nodes would have sent as a change, oldest first.

    Attributes:
        name: the name that the user sees.
        states: the changes; the newest 1000 (10 s of ceaseless motion), so that a dry run of
            days does not grow. The mouse's moving and its stopping are changes too.
        extra_devices: the nodes that a real pad would have beside it.
        travel: total motion of the mouse, in steps, by EV_REL code.
    """

    name = "memory"

    def __init__(self, extra_devices: Iterable[ExtraDevice] = ()) -> None:
        self.states: deque[GamepadState] = deque(maxlen=1_000)
        self.extra_devices = set(extra_devices)
        self.travel: Counter[int] = Counter()
        self._motion = mouse.PointerMotion()
        self._reports = _encode(GamepadState(0))
        self._t_us = 0
        self._closed = False
        self._lock = Lock()

    def prepare(self, extra_devices: Iterable[ExtraDevice]) -> None:
        """Adds these to the nodes.

        Raises:
            DeviceError: the device is closed.
        """
        with self._lock:
            self._require_open()
            self.extra_devices.update(extra_devices)

    def write(self, state: GamepadState) -> None:
        """Records the state if it changes anything.

        Raises:
            DeviceError: the device is closed.
        """
        with self._lock:
            self._require_open()
            self.extra_devices |= find_needed(state)
            steps = self._motion.compute_steps(state)
            if steps:
                self.travel.update(dict(steps))
            self._show(state, moved=bool(steps))

    def neutral(self) -> None:
        """Releases everything, at the moment of the state before."""
        with self._lock:
            if not self._closed:
                self._motion = mouse.PointerMotion()
                self._show(GamepadState(self._t_us), moved=False)

    def close(self) -> None:
        """Releases everything; ignores later writes."""
        self.neutral()
        with self._lock:
            self._closed = True

    def _require_open(self) -> None:
        if self._closed:
            raise DeviceError("The virtual gamepad is already closed.")

    def _show(self, state: GamepadState, *, moved: bool) -> None:
        self._t_us = state.t_us
        reports = _encode(state)
        if moved or reports != self._reports:
            self._reports = reports
            self.states.append(state)


def _encode(state: GamepadState) -> tuple[_Report, _Report, _Report, bool]:
    """Returns the three reports, and whether the mouse moves: its stop is recorded too."""
    moves = any(state.pointer) or state.wheel != 0.0
    return _LAYOUT.encode(state), keyboard.encode_keys(state), mouse.encode_buttons(state), moves
