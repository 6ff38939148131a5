"""Answers games that make the pad shake, quickly enough that no game waits.

A game uploads effects, then plays and stops them by number. The kernel passes each upload to us and
blocks the game until we have answered; without an answer, SDL freezes for a minute.
"""

import ctypes
import errno
import math
import os
import select
import struct
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any, Final

from evdev import ecodes, ff

from neurotouch_hid.device.outputs.effects import STILL, Effects, Rumble, RumbleEffect

N_EFFECTS: Final = 16
"""The kernel keeps this many for pads without a memory of their own."""

EFFECT_CODES: Final = (
    # What the kernel's xpad driver declares; games choose the first of these that they know.
    *(ecodes.FF_RUMBLE, ecodes.FF_PERIODIC, ecodes.FF_SQUARE, ecodes.FF_TRIANGLE),
    *(ecodes.FF_SINE, ecodes.FF_GAIN),
)

_FULL: Final = 0xFFFF

_NICE: Final = -10
"""Above the game's, because the game may use all processors while it waits for us."""

LIBC: Final = ctypes.PyDLL(None, use_errno=True)
"""System calls that keep the interpreter to ourselves. All of them return at once here, and after
each of Python's own we might wait 5 ms for another thread to let us go on."""
LIBC.ioctl.argtypes = (ctypes.c_int, ctypes.c_ulong, ctypes.c_void_p)
LIBC.read.argtypes = (ctypes.c_int, ctypes.c_void_p, ctypes.c_size_t)
LIBC.read.restype = ctypes.c_ssize_t

_INPUT_EVENT: Final = struct.Struct("@llHHi")
_EV_UINPUT: Final = 0x0101
_UI_FF_UPLOAD, _UI_FF_ERASE = 1, 2


def _both_ways(number: int, size: int) -> int:
    """Returns the number of an ioctl that hands ``size`` bytes over and back: ``_IOWR('U', …)``."""
    return 3 << 30 | size << 16 | ord("U") << 8 | number


def _one_way(number: int, size: int) -> int:
    return 1 << 30 | size << 16 | ord("U") << 8 | number


_BEGIN_UPLOAD: Final = _both_ways(200, ctypes.sizeof(ff.UInputUpload))
_END_UPLOAD: Final = _one_way(201, ctypes.sizeof(ff.UInputUpload))
_BEGIN_ERASE: Final = _both_ways(202, ctypes.sizeof(ff.UInputErase))
_END_ERASE: Final = _one_way(203, ctypes.sizeof(ff.UInputErase))


HearRumble = Callable[[Rumble], None]
"""Called with every change, in the server's thread; must return at once."""


class RumbleServer:
    """Answers the kernel's requests to a uinput node; starts immediately.

    It must run before the node is created.

    Args:
        descriptor: of the node; stays the caller's.
        hear: called with every change.
        libc: makes the system calls ``read`` and ``ioctl``; a benchmark answers them itself.
    """

    def __init__(self, descriptor: int, hear: HearRumble, libc: Any = LIBC) -> None:
        os.set_blocking(descriptor, False)
        self._descriptor = descriptor
        self._libc = libc
        self._hear = hear
        self._effects = Effects()
        self._told = STILL
        self._closed = False
        self._wake_read, self._wake_write = os.pipe2(os.O_CLOEXEC | os.O_NONBLOCK)
        self._thread = threading.Thread(target=self._serve, name="rumble", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Ends the thread and the rumble. A second call does nothing."""
        if self._closed:
            return
        self._closed = True
        os.write(self._wake_write, b"x")
        self._thread.join()
        os.close(self._wake_read)
        os.close(self._wake_write)
        self._hear(STILL)

    def _serve(self) -> None:
        with suppress(PermissionError):  # only root and our service may
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _NICE)
        watched = [self._descriptor, self._wake_read]
        until = math.inf
        while True:
            wait_s = None if until == math.inf else max(until - time.monotonic(), 0.0)
            ready, _, _ = select.select(watched, [], [], wait_s)
            if self._wake_read in ready:
                return
            if ready and not self._answer():
                return
            rumble, until = self._effects.sum_up(time.monotonic())
            if rumble != self._told:
                self._told = rumble
                self._hear(rumble)

    def _answer(self) -> bool:
        """Answers all requests; returns False if the node is gone."""
        data = (ctypes.c_char * (64 * _INPUT_EVENT.size))()
        size = self._libc.read(self._descriptor, data, ctypes.sizeof(data))
        if size < 0:  # a signal may come while uinput is busy with a write of ours
            return ctypes.get_errno() in (errno.EAGAIN, errno.EINTR)
        now = time.monotonic()
        for *_, kind, code, value in _INPUT_EVENT.iter_unpack(bytes(data)[:size]):
            if kind == _EV_UINPUT and code == _UI_FF_UPLOAD:
                self._take(value)
            elif kind == _EV_UINPUT and code == _UI_FF_ERASE:
                self._forget(value)
            elif kind == ecodes.EV_FF and code == ecodes.FF_GAIN:
                self._effects.set_gain(min(max(value / _FULL, 0.0), 1.0))
            elif kind == ecodes.EV_FF and code < N_EFFECTS:
                self._effects.play(code, value, now)
        return True

    def _take(self, request: int) -> None:
        upload = ff.UInputUpload(request_id=request)
        if self._call(_BEGIN_UPLOAD, upload):
            self._effects.upload(upload.effect.id, RumbleEffect.read(upload.effect))
            upload.retval = 0
            self._call(_END_UPLOAD, upload)

    def _forget(self, request: int) -> None:
        erase = ff.UInputErase(request_id=request)
        if self._call(_BEGIN_ERASE, erase):
            self._effects.erase(erase.effect_id)
            erase.retval = 0
            self._call(_END_ERASE, erase)

    def _call(self, number: int, argument: ctypes.Structure) -> bool:
        """Makes one system call; returns False if the game has gone meanwhile."""
        while self._libc.ioctl(self._descriptor, number, ctypes.byref(argument)) != 0:
            if ctypes.get_errno() != errno.EINTR:
                return False
        return True
