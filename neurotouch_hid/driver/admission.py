"""Access rules: the users who may command and watch a driver.

These are its owner, root, and for a service the person at the seat. A seat is a screen with its
keyboard and mouse; logind knows who uses it now.
"""

import ctypes
import os
from collections.abc import Callable, Collection
from typing import Final

Guests = Callable[[], Collection[int]]
"""Looks up the users, by uid, who may command beside the owner and root."""

_LIBRARY: Final = "libsystemd.so.0"
"""sd-login(3). Reads files of logind under /run/systemd; no message is sent."""


def is_admitted(uid: int, find_guests: Guests) -> bool:
    """Returns True if a user may command this driver: the owner, root, and a present guest."""
    return uid in (os.geteuid(), 0) or uid in find_guests()


def find_seated_users() -> tuple[int, ...]:
    """Returns the users whose session is in the foreground of a seat, ``seat0`` first.

    Empty where there is no logind.

    udev lets the same users read the pad, and open the camera with a program of their own.
    """
    try:
        library = ctypes.CDLL(_LIBRARY)
    except OSError:
        return ()
    users = []
    for seat in sorted(_list_seats(library)):
        uid = ctypes.c_uint32()
        if library.sd_seat_get_active(seat, None, ctypes.byref(uid)) >= 0:
            users.append(uid.value)
    return tuple(users)


def _list_seats(library: ctypes.CDLL) -> list[bytes]:
    seats = ctypes.POINTER(ctypes.c_void_p)()
    count = library.sd_get_seats(ctypes.byref(seats))
    if count < 0:
        return []
    libc = ctypes.CDLL(None)
    libc.free.argtypes = [ctypes.c_void_p]
    names = []
    for k in range(count):
        names.append(ctypes.string_at(seats[k]))
        libc.free(seats[k])
    libc.free(seats)
    return names
