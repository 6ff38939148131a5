"""Makes functions kernels: each is compiled when it is first called, and kept for the next start.

A kept kernel is loaded as machine code, without numba's compiler and LLVM. They are imported as
soon as one must be compiled.
"""

import os
import pickle
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache, cached_property, partial
from hashlib import sha256
from pathlib import Path
from threading import RLock
from typing import Any, Final, cast

import numpy as np

from neurotouch_hid.process.code_loading import find_fingerprint, find_numba, make_callable
from neurotouch_hid.process.kernel_files import (
    KernelFiles,
    find_cache_trouble,
    read_checked,
    remove,
    write_checked,
)
from neurotouch_hid.process.processor import find_levels, read_abilities

__all__ = ["Kernel", "bind", "find_cache_trouble", "kernel", "load"]

_IS_OFF: Final = os.environ.get("NUMBA_DISABLE_JIT", "0") not in {"", "0"}
_one_at_a_time: Final = RLock()


def kernel(function: Callable[..., Any] | None = None, /, **options: Any) -> Any:
    """Makes a function a kernel, which runs without the interpreter's lock.

    Args:
        function: what is compiled when it is first called.
        options: of ``numba.njit``.
    """
    if function is None:
        return lambda function: kernel(function, **options)
    return function if _IS_OFF else Kernel(function, options)


def bind(function: Callable[..., Any], *first: Any) -> Callable[..., Any]:
    """Returns a kernel whose first arguments are given.

    The types of these are found once, not in each call: of a record or a tuple with many fields
    that takes up to 15 µs.

    Args:
        function: a kernel.
        first: its first arguments. An array must keep its dtype and its flags.
    """
    if not isinstance(function, Kernel):
        return partial(function, *first)
    found: dict[bytes, Callable[..., Any]] = {}

    def call(*args: Any) -> Any:
        try:
            compiled = found[_fingerprint(args)]
        except (KeyError, NotImplementedError):
            compiled = partial(function.find(*first, *args), *first)
            with suppress(NotImplementedError):  # then numba looks at them in each call
                found[_fingerprint(args)] = compiled
        return compiled(*args)

    return call


def load(function: Callable[..., Any], *args: Any) -> None:
    """Loads a kernel that is seldom called, so that its first call does not have to compile it.

    Args:
        function: a kernel.
        args: arguments of the types that its calls will have; it is not called.
    """
    if not isinstance(function, Kernel):
        return
    if function.find(*args) is vars(function).get("dispatcher"):  # numba compiles in the first call
        from neurotouch_hid.process.kernel_compiler import compile_for  # noqa: PLC0415

        compile_for(function.dispatcher, args)


class Kernel:
    """A function that runs as machine code; it is found by the types of its arguments.

    Args:
        function: the kernel in Python.
        options: of ``numba.njit``.

    Attributes:
        py_func: the kernel in Python.
        targetoptions: the options; under this name numba asks for them.
    """

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        self.py_func = function
        self.targetoptions = options
        self.__doc__ = function.__doc__
        self.__name__ = function.__name__
        self.__module__ = function.__module__
        self._found: dict[bytes, Callable[..., Any]] = {}

    def __call__(self, *args: Any) -> Any:  # noqa: D102
        try:  # as in ``find``, which would be one more call for each of ours
            function = self._found[_fingerprint(args)]
        except (KeyError, NotImplementedError):
            function = self._find(args)
        return function(*args)

    def find(self, *args: Any) -> Callable[..., Any]:
        """Returns the function for arguments of these types."""
        try:
            return self._found[_fingerprint(args)]
        except (KeyError, NotImplementedError):
            return self._find(args)

    def __repr__(self) -> str:
        return f"<kernel {self.py_func.__module__}.{self.py_func.__qualname__}>"

    @property
    def n_variants(self) -> int:
        """For how many types of arguments there is machine code in this process."""
        return len(self._found)

    @cached_property
    def files(self) -> KernelFiles:
        """Files in which the compiled kernel is kept."""
        return KernelFiles(self.py_func)

    @cached_property
    def dispatcher(self) -> Any:
        """Object of numba for this kernel; it imports numba."""
        from neurotouch_hid.process.kernel_compiler import make_dispatcher  # noqa: PLC0415

        return make_dispatcher(self.py_func, self.targetoptions, self.files)

    @property
    def _numba_type_(self) -> Any:
        # numba asks for it when it compiles another kernel that calls this one.
        return self.dispatcher._numba_type_

    def _find(self, args: tuple[Any, ...]) -> Callable[..., Any]:
        """Returns the function for arguments of these types: loaded or, if need be, compiled."""
        with _one_at_a_time:
            try:
                fingerprint, words = _fingerprint(args), _describe(args)
            except NotImplementedError:  # arguments, or a numba, that we do not know
                return cast("Callable[..., Any]", self.dispatcher)
            function = self._load_packaged(words) or self._load_own(args, words)
            self._found[fingerprint] = function
            return function

    def _load_packaged(self, words: object) -> Callable[..., Any] | None:
        """Returns the function as it came with the package, for the highest level there is."""
        paths = (self.files.find_packaged((words, *level), "code") for level in _list_levels())
        return next(filter(None, map(self._load, paths)), None)

    def _load_own(self, args: tuple[Any, ...], words: object) -> Callable[..., Any]:
        """Returns the function that was compiled for this machine, or compiles it."""
        machine = _describe_machine()
        if machine is None:
            return cast("Callable[..., Any]", self.dispatcher)
        path = self.files.find_path((words, *machine), "code")
        return self._load(path) or self._compile(args, path)

    def _load(self, path: Path) -> Callable[..., Any] | None:
        content = read_checked(path)
        if content is None:
            return None
        try:
            name, linked = pickle.loads(content)  # noqa: S301  # our own file
            if name == path.name:
                return make_callable(linked, sys.modules[self.__module__], self.__name__)
        except Exception:  # noqa: S110  # whatever is wrong with it, it can be compiled again
            pass
        remove(path)
        return None

    def _compile(self, args: tuple[Any, ...], path: Path) -> Callable[..., Any]:
        from neurotouch_hid.process.kernel_compiler import compile_for  # noqa: PLC0415

        function: Callable[..., Any]
        function, linked = compile_for(self.dispatcher, args)
        if linked is not None:
            write_checked(path, pickle.dumps((path.name, linked)))
        return function


def _find_fingerprint(args: tuple[Any, ...]) -> bytes:
    """Replaces itself by numba's own function, with the first call of a kernel."""
    global _fingerprint  # noqa: PLW0603
    try:
        _fingerprint = find_fingerprint()
    except (ImportError, AttributeError):  # a numba that we do not know
        _fingerprint = _find_none
    return _fingerprint(args)


def _find_none(_: object) -> bytes:
    raise NotImplementedError


_fingerprint: Callable[[Any], bytes] = _find_fingerprint


def _describe(value: object) -> object:
    """Returns what numba knows of an argument when it compiles, in words that last.

    Raises:
        NotImplementedError: such an argument is left to numba.
    """
    if type(value) is np.ndarray:
        flags = value.flags
        layout = "C" if flags.c_contiguous else "F" if flags.f_contiguous else "A"
        words = _describe_type(value.dtype), value.ndim, layout
        return (*words, flags.writeable, flags.aligned)
    if isinstance(value, np.generic):
        return "scalar", _describe_type(value.dtype)
    if type(value) is tuple:
        return "tuple", *map(_describe, value)
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        named = type(value)
        return named.__module__, named.__qualname__, named._fields, *map(_describe, value)
    if value is None or type(value) in {bool, float, complex}:
        return type(value).__name__
    if type(value) is int and value.bit_length() < 64:
        return "int"
    raise NotImplementedError(type(value).__name__)


def _describe_type(dtype: np.dtype[Any]) -> object:
    if dtype.names is None or dtype.fields is None:
        return dtype.str
    fields = [(name, _describe_type(each), at) for name, (each, at, *_) in dtype.fields.items()]
    return fields, dtype.itemsize, dtype.isalignedstruct


@cache
def _describe_machine() -> tuple[object, ...] | None:
    """Returns on what machine code depends, apart from its source; None if nobody tells."""
    name, features = os.environ.get("NUMBA_CPU_NAME"), os.environ.get("NUMBA_CPU_FEATURES")
    # Then numba does not look at this processor, and the code runs on others as well.
    is_chosen = name == "generic" or None not in {name, features}
    processor = "" if is_chosen else read_abilities()
    return (*_describe_compiler(), name, features, processor) if is_chosen or processor else None


@cache
def _list_levels() -> list[tuple[object, ...]]:
    """Returns the same for the levels of x86-64 that this processor has, the highest first."""
    if os.environ.keys() & {"NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"}:
        return []
    return [(*_describe_compiler(), level, "", "") for level in find_levels(read_abilities())]


@cache
def _describe_compiler() -> tuple[str, str]:
    # Within a minor version Python's interface for machine code stays; numba's cache relies on it.
    python = f"{sys.implementation.cache_tag}{sys.abiflags}"
    return python, sha256((find_numba() / "_version.py").read_bytes()).hexdigest()
