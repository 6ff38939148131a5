"""The server of a pad's rumble, with a kernel that is interrupted; a real one is tested too."""

import ctypes
import errno
import os
import struct
import threading

from evdev import ecodes, ff

from neurotouch_hid.device.outputs.effects import Rumble
from neurotouch_hid.device.outputs.rumble import RumbleServer

LIMIT_S = 60.0
EVENT = struct.Struct("@llHHi")
UPLOAD = EVENT.pack(0, 0, 0x0101, 1, 7)  # a request of the kernel's, number 7
PLAY = EVENT.pack(0, 0, ecodes.EV_FF, 0, 1)


class InterruptedKernel:
    """Answers as Linux does where a signal comes: each call has to be made twice."""

    def __init__(self) -> None:
        self._is_interrupted = True
        self.n_uploads = 0

    def read(self, descriptor, data, size) -> int:
        if self._interrupt():
            return -1
        said = os.read(descriptor, size)
        ctypes.memmove(data, said, len(said))
        return len(said)

    def ioctl(self, _descriptor, number, argument) -> int:
        if self._interrupt():
            return -1
        upload = ctypes.cast(argument, ctypes.POINTER(ff.UInputUpload)).contents
        assert upload.request_id == 7
        if number >> 30 == 3:  # the begin of an upload, which hands over what the game wants
            upload.effect.type = ecodes.FF_RUMBLE
            upload.effect.id = 0
            upload.effect.u.ff_rumble_effect.strong_magnitude = 0xFFFF
        else:
            self.n_uploads += 1
        return 0

    def _interrupt(self) -> bool:
        was, self._is_interrupted = self._is_interrupted, not self._is_interrupted
        if was:
            ctypes.set_errno(errno.EINTR)
        return was


def test_a_signal_in_the_middle_leaves_no_game_without_an_answer():
    told: list[Rumble] = []
    changed = threading.Event()
    kernel = InterruptedKernel()
    node, games = os.pipe()
    server = RumbleServer(node, lambda rumble: (told.append(rumble), changed.set()), libc=kernel)
    try:
        os.write(games, UPLOAD + PLAY)
        assert changed.wait(LIMIT_S)
    finally:
        server.close()
        os.close(node)
        os.close(games)
    assert kernel.n_uploads == 1
    assert (told[0].strong, told[0].weak) == (1.0, 0.0)
