"""Makes linked machine code callable, without numba's compiler and LLVM.

numba's runtime is a few small libraries that its package brings along. The code calls them for
the memory of arrays, for errors, and to take its arguments from Python's objects.
"""

import ctypes
import mmap
import pickle
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from importlib import import_module
from importlib.machinery import EXTENSION_SUFFIXES, ExtensionFileLoader, ModuleSpec
from importlib.util import find_spec, module_from_spec
from pathlib import Path
from types import ModuleType
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.machine_code import LinkedCode

_PACKAGE: Final = "numba"
_RUNTIME: Final = "core.runtime._nrt_python"
_SHA1_BYTES: Final = 20
_NUMBERS: Final = (
    *(f"{kind}{bits}" for kind in ("int", "uint") for bits in (8, 16, 32, 64)),
    *("float32", "float64", "complex64", "complex128"),
)
_in_use: list[mmap.mmap] = []
"""Code stays in memory until the process ends."""


class _NoArgument:
    """Stands for an argument that is left out. No call of ours leaves one out."""


@cache
def find_numba() -> Path:
    """Returns the folder of numba, which need not be imported for that.

    Raises:
        ImportError: it is not installed.
    """
    spec = find_spec(_PACKAGE)
    if spec is None or spec.origin is None:
        raise ImportError(f"No module named '{_PACKAGE}'", name=_PACKAGE)
    return Path(spec.origin).parent


def make_callable(linked: LinkedCode, module: ModuleType, name: str) -> Callable[..., Any]:
    """Returns a function that runs linked code.

    Args:
        linked: the code; it must be of this version of numba and for this processor.
        module: of the function in Python.
        name: of that function.

    Raises:
        KeyError: nobody has a symbol of this name.
        OSError: no memory, or the system allows no new code.
    """
    functions = _import_part("_dynfunc")
    memory = mmap.mmap(-1, linked.size, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    address = ctypes.addressof(ctypes.c_char.from_buffer(memory))
    content = np.frombuffer(memory, np.uint8)
    content[: len(linked.content)] = np.frombuffer(linked.content, np.uint8)
    _write(content, linked.inner[:, 0], linked.inner[:, 1] + address)
    symbols = np.array([_find_symbol(name) for name in linked.symbols], np.int64)
    _write(content, linked.outer[:, 0], symbols[linked.outer[:, 1]] + linked.outer[:, 2])
    environments = []
    for constants in linked.environments.values():
        environment = functions.Environment(vars(module))
        environment.consts.extend(constants)
        environments.append(environment)
    places = np.array([*linked.environments], np.int64)
    _write(content, places, np.array([*map(id, environments)], np.int64))
    _allow_execution(address, linked.data_start)
    _in_use.append(memory)
    function: Callable[..., Any] = functions.make_function(
        module, name, "", address + linked.entry, environments[0], tuple(environments)
    )
    return function


def find_fingerprint() -> Callable[[object], bytes]:
    """Returns numba's function that tells types of arguments apart, for this process only.

    Its answer is short and comes within a microsecond. For a dtype with fields it has the
    address of the first equal one, which numba keeps.
    """
    fingerprint: Callable[[object], bytes] = _import_part("_dispatcher").compute_fingerprint
    return fingerprint


def _write(
    content: NDArray[np.uint8], places: NDArray[np.int64], values: NDArray[np.int64]
) -> None:
    """Writes addresses; their places need not be multiples of anything."""
    content[places[:, None] + np.arange(8)] = values[:, None].view(np.uint8)


def _allow_execution(address: int, size: int) -> None:
    protect = ctypes.CDLL(None, use_errno=True).mprotect
    protect.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
    if protect(address, size, mmap.PROT_READ | mmap.PROT_EXEC):
        raise OSError(ctypes.get_errno(), "mprotect")


@cache
def _find_symbol(name: str) -> int:
    known = _name_symbols()
    if name in known:
        return known[name]
    for library in (ctypes.pythonapi, ctypes.CDLL(None), ctypes.CDLL("libm.so.6")):
        with suppress(ValueError):
            return ctypes.addressof(ctypes.c_char.in_dll(library, name))
    raise KeyError(name)


@cache
def _name_symbols() -> dict[str, int]:
    """Returns the addresses of numba's own functions, by the names that compiled code uses."""
    helpers = _import_part("_helperlib").c_helpers
    if _PACKAGE not in sys.modules:
        _give_unpickle(helpers["unpickle"])
    runtime = _import_part(_RUNTIME).c_helpers
    return {f"numba_{name}": address for name, address in helpers.items()} | {
        name if name.startswith("_") else f"NRT_{name}": address
        for name, address in runtime.items()
    }


def _give_unpickle(address: int) -> None:
    """Calls numba's function for constants once, so that it does not import numba for it later.

    It looks for its Python part at its first call, and keeps it.
    """
    constants: dict[tuple[int, bytes], object] = {}

    def unpickle(address: int, content: bytes, digest: bytes) -> object:
        key = address, digest
        if key not in constants:
            constants[key] = pickle.loads(content)  # noqa: S301  # of the code that calls it
        return constants[key]

    text = ctypes.c_char_p
    call = ctypes.PYFUNCTYPE(ctypes.py_object, text, ctypes.c_int, text)(address)
    content = pickle.dumps(None)
    serialize = ModuleType(f"{_PACKAGE}.core.serialize")
    serialize._numba_unpickle = unpickle  # type: ignore[attr-defined]
    with _stand_in(ModuleType(_PACKAGE), serialize):
        call(content, len(content), bytes(_SHA1_BYTES))


@cache
def _import_part(name: str) -> Any:
    """Imports a library of numba without the package, which would import its compiler.

    A later import of numba finds it.
    """
    if _PACKAGE in sys.modules:
        return import_module(f"{_PACKAGE}.{name}")
    return _import_dispatcher() if name == "_dispatcher" else _import_alone(name)


def _import_dispatcher() -> ModuleType:
    package = ModuleType(_PACKAGE)  # in which this library looks for another one
    package._devicearray = _import_alone("_devicearray")  # type: ignore[attr-defined]
    with _stand_in(package):
        dispatcher = _import_alone("_dispatcher")
    # Fingerprints need no numbers of types, but fail before they have been given once. numba does
    # so again.
    dispatcher.typeof_init(_NoArgument, dict.fromkeys(_NUMBERS, 0))
    return dispatcher


@contextmanager
def _stand_in(*modules: ModuleType) -> Iterator[None]:
    """Lets these modules be found instead of those of numba."""
    sys.modules.update({module.__name__: module for module in modules})
    try:
        yield
    finally:
        for module in modules:
            del sys.modules[module.__name__]


def _import_alone(name: str) -> ModuleType:
    whole = f"{_PACKAGE}.{name}"
    if whole in sys.modules:
        return sys.modules[whole]
    path = find_numba() / name.replace(".", "/")
    for suffix in EXTENSION_SUFFIXES:
        if (file := path.parent / (path.name + suffix)).exists():
            loader = ExtensionFileLoader(whole, str(file))
            module = module_from_spec(ModuleSpec(whole, loader, origin=str(file)))
            loader.exec_module(module)
            sys.modules[whole] = module
            return module
    raise ImportError(f"No module named '{whole}'", name=whole)
