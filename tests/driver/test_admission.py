"""Who sits at the machine. A whole Debian with somebody at it is in tests/system."""

import ctypes
import os
import pwd
import shutil

import pytest

from neurotouch_hid.driver.admission import find_seated_users, is_admitted
from tests.processes import run_command


def ask_logind(*question: str) -> list[str]:
    """What loginctl says, in lines; nothing where there is no logind."""
    if not shutil.which("loginctl"):
        return []
    said = run_command("loginctl", *question, code=None)
    return said.stdout.split()


def test_they_are_the_users_that_loginctl_shows_at_a_seat():
    users = set()
    for seat in ask_logind("list-seats", "--no-legend"):
        for session in ask_logind("show-seat", seat, "--property=ActiveSession", "--value"):
            names = ask_logind("show-session", session, "--property=Name", "--value")
            users |= {pwd.getpwnam(name).pw_uid for name in names}
    assert set(find_seated_users()) == users


def test_the_owner_root_and_the_guests_are_admitted_and_nobody_else(monkeypatch):
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    admitted = [uid for uid in (-1, 0, 1, 1000, 1001, 1002) if is_admitted(uid, lambda: (1001,))]
    assert admitted == [0, 1000, 1001]
    assert not is_admitted(1001, frozenset)


class Logind:
    """libsystemd with these seats, or none that answers; an unused seat has no user."""

    def __init__(self, seats: dict[bytes, int | None] | None) -> None:
        self._seats = seats
        self.names = [ctypes.create_string_buffer(name) for name in seats or ()]
        self.array = (ctypes.c_void_p * (len(self.names) + 1))(*map(ctypes.addressof, self.names))

    def sd_get_seats(self, reference) -> int:
        if self._seats is None:
            return -1  # EPERM
        reference._obj.contents = ctypes.c_void_p.from_buffer(self.array)
        return len(self._seats)

    def sd_seat_get_active(self, seat: bytes, session: None, uid) -> int:
        user = self._seats[seat]
        if user is None:
            return -1
        uid._obj.value = user
        return 0


class Memory:
    """What is given back to the C library."""

    def __init__(self) -> None:
        self.freed: list[int] = []
        self.argtypes: list[type] = []

    def __call__(self, pointer) -> None:
        assert self.argtypes == [ctypes.c_void_p]  # an int argument would be cut to 32 bits
        self.freed.append(ctypes.cast(pointer, ctypes.c_void_p).value)


@pytest.mark.parametrize(
    ("seats", "users"),
    [
        ({b"seat1": 1002, b"seat0": 0, b"seat2": None}, (0, 1002)),
        ({b"seat0": 1000}, (1000,)),
        ({}, ()),
        (None, ()),
    ],
)
def test_every_seat_is_asked_and_its_memory_given_back(monkeypatch, seats, users):
    logind, memory = Logind(seats), Memory()
    libc = type("LibC", (), {"free": memory})
    monkeypatch.setattr(ctypes, "CDLL", lambda name: libc if name is None else logind)
    assert find_seated_users() == users
    lent = [*map(ctypes.addressof, logind.names), ctypes.addressof(logind.array)]
    assert memory.freed == ([] if seats is None else lent)


def test_without_logind_nobody_sits_here(monkeypatch):
    def load(name):
        raise OSError(name)

    monkeypatch.setattr(ctypes, "CDLL", load)
    assert find_seated_users() == ()
