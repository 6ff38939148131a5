"""An object that is not understood is refused; then numba loads the kernel itself."""

import struct
import sys

import numba
import numpy as np
import pytest

from neurotouch_hid.process.code_loading import make_callable
from neurotouch_hid.process.machine_code import CannotLinkError, link

X86_64, AARCH64 = 62, 183
LOCKED = b"\xf0\x48\xff"  # how ``lock inc`` and ``lock dec`` begin


def make_header(machine, n_sections=0):
    magic = b"\x7fELF\x02\x01\x01" + bytes(9)
    return struct.pack(
        "<16sHHIQQQIHHHHHH", magic, 1, machine, 1, 0, 0, 64, 0, 64, 0, 0, 64, n_sections, 0
    )


@pytest.mark.parametrize(
    "code",
    [
        b"",
        b"no object" * 20,
        make_header(AARCH64, 1) + bytes(64),
        make_header(X86_64),
        make_header(X86_64, 1) + bytes(64),  # without symbols
        make_header(X86_64, 2) + bytes(64),  # cut off
    ],
)
def test_what_is_not_understood_is_refused(code):
    with pytest.raises(CannotLinkError):
        link(code, "function", {})


def test_a_section_of_variables_is_refused():
    writable_and_in_memory = 1 | 2
    section = struct.pack("<IIQQQQIIQQ", 0, 1, writable_and_in_memory, 0, 128, 8, 0, 0, 8, 0)
    code = make_header(X86_64, 1) + section + bytes(8)
    with pytest.raises(CannotLinkError, match="variables"):
        link(code, "function", {})


def test_numba_counts_with_a_lock_unless_it_is_taken_away():
    """The arrays that a kernel takes and makes are counted several times in each call."""

    @numba.njit
    def share(array):
        return array, array[1:], array + 1.0

    share(np.zeros(3))
    (compiled,) = share.overloads.values()
    (_, _, (code, _)), description, environment, *_ = compiled._reduce()
    assert code.count(LOCKED) == 2, "numba counts without a lock, or elsewhere"
    constants = {environment.env_name: list(environment.consts)}
    linked = link(code, description.llvm_cpython_wrapper_name, constants)
    assert LOCKED not in linked.content

    function, array = make_callable(linked, sys.modules[__name__], "share"), np.zeros(3)
    n_users = sys.getrefcount(array)
    whole, rest, new = function(array)
    assert whole is array
    assert sys.getrefcount(array) == n_users + 2
    del whole, rest, new
    assert sys.getrefcount(array) == n_users
