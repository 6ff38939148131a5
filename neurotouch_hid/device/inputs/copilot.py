"""A physical pad, keyboard or switch that plays on the same virtual pad as the gel."""

import os
import selectors
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Final

from evdev import InputDevice, ecodes

from neurotouch_hid.device.inputs.contribution import Contribution
from neurotouch_hid.device.inputs.discovery import explain_opening, find_alike, find_copilot
from neurotouch_hid.device.inputs.nodes import Input
from neurotouch_hid.device.inputs.rumble_player import RumblePlayer
from neurotouch_hid.device.inputs.translation import Translation
from neurotouch_hid.device.outputs.effects import Rumble
from neurotouch_hid.errors import DeviceError
from neurotouch_hid.messages import Button

_SEARCH_S: Final = 1.0
HearShare = Callable[[Contribution], None]
"""Called with every change, in the co-pilot's thread."""


class Copilot:
    """Grabs a device, reports its contribution, and finds it again when it comes back.

    Other programs receive nothing from the device while it is grabbed. Pressed buttons must be
    released before the grab: a program that has seen the press must see the release.

    Args:
        wanted: the device, see ``find_copilot``.
        keys: the person's own meanings of keys: buttons by the kernel's names of keys.
        wait: the device need not be there yet.

    Raises:
        DeviceError: it is not there, another program has taken it, or we may not read it.
    """

    def __init__(
        self, wanted: str, keys: Mapping[str, Button] | None = None, *, wait: bool = False
    ) -> None:
        self._wanted = wanted
        self._keys = keys
        self._device: Input | None = None
        self._trouble = ""  # why it does not play, before it has come for the first time
        self._others: set[Path] = set()  # devices of the same kind that are not the helper's
        self._hear: HearShare = _ignore
        self._chords: Mapping[str, frozenset[int]] = {}
        self._hear_chord: Callable[[str], object] = _ignore
        self._held_chords: set[str] = set()
        self._share = Contribution()
        self._open: InputDevice | None = None
        self._shaker: RumblePlayer | None = None
        self._grabbed = False
        self._down: set[int] = set()
        self._values: dict[int, int] = {}
        self._selector = selectors.DefaultSelector()
        self._wake_read, self._wake_write = os.pipe2(os.O_CLOEXEC | os.O_NONBLOCK)
        self._selector.register(self._wake_read, selectors.EVENT_READ)
        try:
            self._take(find_copilot(wanted))
        except DeviceError as error:
            self._trouble = error.message
            self._let_go()
            if not wait:
                self._close_pipe()
                raise
        self._thread = threading.Thread(target=self._run, name="co-pilot", daemon=True)

    @property
    def rumbles(self) -> bool:
        """True if the device can shake, or has not been seen yet."""
        return self._device is None or bool(self._device.effects >> ecodes.FF_RUMBLE & 1)

    @property
    def share(self) -> Contribution:
        """Its present contribution."""
        return self._share

    def describe(self) -> str:
        """Returns its name and whether it is connected."""
        if self._device is None or self._trouble:
            return f"waits for {self._wanted}. {self._trouble}"
        if self._open is None:
            return f"{self._device.name} is unplugged; it works again once it is back"
        if not self._grabbed:
            return f"{self._device.name} plays along once all its buttons are released"
        return f"{self._device.name} ({self._open.path})"

    def start(self, hear: HearShare) -> None:
        """Starts to call ``hear`` with every change; ``hear`` must return at once."""
        self._hear = hear
        self._thread.start()

    def listen(self, chords: Mapping[str, tuple[str, ...]], hear: Callable[[str], object]) -> None:
        """Calls ``hear`` for keys held together on the device, which other programs cannot read."""
        self._hear_chord = hear
        self._chords = {
            name: frozenset(ecodes.ecodes[key] for key in keys) for name, keys in chords.items()
        }

    def shake(self, rumble: Rumble) -> None:
        """Makes the device shake, if it is connected and can; returns at once."""
        shaker = self._shaker
        if shaker is not None:
            shaker.shake(rumble)

    def close(self) -> None:
        """Releases the device. A second call does nothing."""
        if self._selector.get_map() is None:
            return
        os.write(self._wake_write, b"x")
        if self._thread.is_alive():
            self._thread.join()
        self._let_go()
        self._close_pipe()

    def _close_pipe(self) -> None:
        self._selector.close()
        os.close(self._wake_read)
        os.close(self._wake_write)

    def _run(self) -> None:
        while True:
            wait_s = _SEARCH_S if self._open is None else None
            for key, _ in self._selector.select(wait_s):
                if key.fd == self._wake_read:
                    return
                self._read()
            if self._open is None:
                self._search()

    def _search(self) -> None:
        """Looks for the device; wireless ones come back at another node."""
        try:
            if self._device is None:
                self._take(find_copilot(self._wanted))
                return
            for each in find_alike(self._device):
                if each.node not in self._others:
                    self._take(each)
                    return
        except DeviceError as error:  # it is not there yet, or its rights are not
            self._trouble = error.message
            self._let_go()

    def _take(self, device: Input) -> None:
        try:
            opened = InputDevice(device.node)
        except OSError as error:
            raise explain_opening(device, error) from None
        except UnicodeDecodeError:  # evdev wants text of every device
            raise DeviceError(
                f"'{device.name}' ({device.node}) cannot be read: its name is not valid text."
            ) from None
        self._open = opened
        self._device = device
        # Known now, not when it is gone: it may be back before we have noticed that it went.
        self._others = {each.node for each in find_alike(device)} - {device.node}
        ranges = {
            code: (info.min, info.max, info.flat)
            for code, info in opened.capabilities(absinfo=True).get(ecodes.EV_ABS, [])
        }
        self._translation = Translation(device, ranges, self._keys)
        if not (self._translation.codes & _list_bits(device.keys) or self._translation.axis_codes):
            raise DeviceError(f"'{device.name}' has no key, button or stick that means something.")
        self._selector.register(opened.fd, selectors.EVENT_READ)
        if self.rumbles:
            self._shaker = RumblePlayer(opened)
        self._grab_when_idle()
        self._trouble = ""

    def _grab_when_idle(self) -> None:
        opened, device = self._open, self._device
        assert opened is not None  # noqa: S101
        assert device is not None  # noqa: S101
        try:
            if opened.active_keys():
                return
            opened.grab()
            self._grabbed = True
            self._look()
        except OSError as error:
            raise explain_opening(device, error) from None

    def _look(self) -> None:
        """Reads the state of all keys and axes, at the start and after a lost event."""
        opened = self._open
        assert opened is not None  # noqa: S101
        self._down = set(opened.active_keys())
        self._values = {code: opened.absinfo(code).value for code in self._translation.axis_codes}
        self._tell()

    def _read(self) -> None:
        opened = self._open
        if opened is None:
            return
        try:
            for event in opened.read():
                self._note(event.type, event.code, event.value)
            if not self._grabbed:
                self._grab_when_idle()
        except BlockingIOError:
            return
        except (OSError, DeviceError):
            self._let_go()

    def _note(self, kind: int, code: int, value: int) -> None:
        if not self._grabbed:
            return
        if kind == ecodes.EV_KEY and value == 1:
            self._down.add(code)
        elif kind == ecodes.EV_KEY and value == 0:
            self._down.discard(code)
        elif kind == ecodes.EV_ABS:
            self._values[code] = value
        elif kind == ecodes.EV_SYN and code == ecodes.SYN_DROPPED:
            self._look()
        elif kind == ecodes.EV_SYN and code == ecodes.SYN_REPORT:
            self._tell()

    def _tell(self) -> None:
        share = self._translation.read(self._down, self._values)
        if share != self._share:
            self._share = share
            self._hear(share)
        for name, keys in self._chords.items():
            if not keys <= self._down:
                self._held_chords.discard(name)
            elif name not in self._held_chords:
                self._held_chords.add(name)
                self._hear_chord(name)

    def _let_go(self) -> None:
        """Forgets a device that is gone or released, with all buttons that were down."""
        opened, self._open = self._open, None
        self._grabbed = False
        self._down.clear()
        self._values.clear()
        if self._share != Contribution():
            self._share = Contribution()
            self._hear(self._share)
        if opened is not None:
            with suppress(KeyError):
                self._selector.unregister(opened.fd)
            if self._shaker is not None:
                self._shaker.close()
                self._shaker = None
            with suppress(OSError):
                opened.close()


def _list_bits(bits: int) -> set[int]:
    return {code for code in range(bits.bit_length()) if bits >> code & 1}


def _ignore(_: object) -> None:
    """Ignores a change before ``start``."""
