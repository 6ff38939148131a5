"""Who sits at the machine, as logind knows it."""

import ctypes
from typing import Final

_LIBRARY: Final = "libsystemd.so.0"
"""sd-login(3). Reads what logind wrote under /run/systemd; no message is sent, nobody is asked."""


def find_seated_users() -> frozenset[int]:
    """The users whose session is in the foreground of a seat; empty where there is no logind.

    They are the ones whom udev lets read the pad, and the camera of a program of their own.
    """
    try:
        library = ctypes.CDLL(_LIBRARY, use_errno=True)
    except OSError:
        return frozenset()
    users = set()
    for seat in _list_seats(library):
        uid = ctypes.c_uint32()
        if library.sd_seat_get_active(seat, None, ctypes.byref(uid)) >= 0:
            users.add(uid.value)
    return frozenset(users)


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
