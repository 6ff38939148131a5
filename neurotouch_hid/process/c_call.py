"""Calls functions of C libraries, also from kernels."""

from ctypes import CFUNCTYPE, c_int, c_void_p, cast
from typing import Any


def call_c(function: int, args: tuple[int, ...]) -> int:
    """Returns the int that a function of C returns.

    In a kernel it is a plain call of C, see ``kernel_compiler``.

    Args:
        function: its address.
        args: whole numbers and addresses.
    """
    result: int = CFUNCTYPE(c_int, *[c_void_p] * len(args))(function)(*map(int, args))
    return result


def find_address(function: Any) -> int:
    """Returns the address of a function that ctypes has found, or of a pointer's target."""
    return cast(function, c_void_p).value or 0
