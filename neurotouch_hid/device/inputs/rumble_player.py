"""Makes a physical pad shake, in a separate thread because the pad's driver may be slow."""

import ctypes
import fcntl
import threading
from contextlib import suppress
from typing import Final

from evdev import InputDevice, ecodes, ff

from neurotouch_hid.device.outputs.effects import STILL, Rumble

_FULL: Final = 0xFFFF
_LONGEST_MS: Final = 0x7FFF
"""The longest effect that the kernel's documentation allows."""

_EVIOCSFF: Final = 1 << 30 | ctypes.sizeof(ff.Effect) << 16 | ord("E") << 8 | 0x80


def upload_effect(pad: InputDevice, effect: ff.Effect) -> int:
    """Uploads an effect to a pad and returns its number there.

    evdev's own function blocks all threads until the pad's driver has answered, and that driver
    may be a program that takes half a minute to fail.
    """
    fcntl.ioctl(pad.fd, _EVIOCSFF, effect)
    return int(effect.id)


class RumblePlayer:
    """Plays the newest rumble on a pad; its callers never wait.

    Args:
        pad: opened for reading and writing; stays the caller's.
    """

    def __init__(self, pad: InputDevice) -> None:
        self._pad = pad
        self._effect = -1  # the number the kernel gives it
        self._changed = threading.Condition()
        self._newest: Rumble | None = None
        self._closed = False
        self._thread = threading.Thread(target=self._work, name="shaker", daemon=True)
        self._thread.start()

    def shake(self, rumble: Rumble) -> None:
        """Plays this rumble from now on."""
        with self._changed:
            self._newest = rumble
            self._changed.notify()

    def close(self) -> None:
        """Stops the rumble and ends the thread."""
        with self._changed:
            self._newest = STILL
            self._closed = True
            self._changed.notify()
        self._thread.join(1.0)  # a driver that hangs must not delay the end

    def _work(self) -> None:
        while True:
            with self._changed:
                while self._newest is None and not self._closed:
                    self._changed.wait()
                rumble, self._newest = self._newest, None
            if rumble is None:
                return
            with suppress(OSError):  # the pad is gone; the reader of its events will notice
                self._show(rumble)

    def _show(self, rumble: Rumble) -> None:
        if rumble.seconds > 0.0:
            motors = ff.Rumble(round(rumble.strong * _FULL), round(rumble.weak * _FULL))
            length_ms = min(max(round(rumble.seconds * 1e3), 1), _LONGEST_MS)
            effect = ff.Effect(
                ecodes.FF_RUMBLE,
                self._effect,
                0,
                ff.Trigger(0, 0),
                ff.Replay(length_ms, 0),
                ff.EffectType(ff_rumble_effect=motors),
            )
            self._effect = upload_effect(self._pad, effect)
            self._pad.write(ecodes.EV_FF, self._effect, 1)
        elif self._effect >= 0:
            self._pad.write(ecodes.EV_FF, self._effect, 0)
