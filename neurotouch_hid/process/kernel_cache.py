"""Compiles kernels, and keeps what was compiled for the next start.

numba's own cache believes whatever it reads, and asks only whether the kernel's own file has
changed. Here a damaged file is compiled again, and so is a kernel that calls one that has changed.
"""

import os
import pickle
import platform
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from hashlib import sha1, sha256
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any, Final

import numba
from numba.core.codegen import JITCodeLibrary, ll
from numba.core.compiler import CompileResult, compile_result
from numba.core.runtime import rtsys
from numba.core.serialize import dumps

from neurotouch_hid.partial_file import write_whole
from neurotouch_hid.process.source_stamp import stamp

_DIGEST_BYTES: Final = sha256().digest_size
_troubles: list[str] = []


def kernel(function: Callable[..., Any] | None = None, /, **options: Any) -> Any:
    """Makes a function a kernel, which runs without the interpreter's lock.

    Args:
        function: what is compiled when it is first called.
        options: of ``numba.njit``.
    """
    if function is None:
        return lambda function: kernel(function, **options)
    dispatcher = numba.njit(nogil=True, **options)(function)
    if not numba.config.DISABLE_JIT:
        dispatcher._cache = KernelCache(function)
    return dispatcher


def find_cache_trouble() -> str:
    """Returns a sentence about why a compiled kernel could not be kept; empty if all were."""
    return next(iter(_troubles), "")


class KernelCache:
    """Cache of one kernel: numba asks it for compiled code, and gives it each new one.

    There is one file for each kernel, signature, processor model and version of Python and numba.
    It begins with a digest of the rest.

    Args:
        function: the kernel in Python.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        source = Path(function.__code__.co_filename)
        state = stamp(source)[:12]
        self.cache_path = str(_find_folder(source.parent))
        _remove_others(Path(self.cache_path), source.stem, state)
        line = function.__code__.co_firstlineno
        self._name = f"{source.stem}.{function.__qualname__}-{line}-{state}"

    def load_overload(self, signature: Any, target: Any) -> Any:
        """Returns the compiled kernel, or None; what cannot be used is removed.

        Compiled code needs numba's runtime only. numba's own cache loads 60 modules more here,
        which compile what is not kept; numba loads them as soon as it has to compile.
        """
        rtsys.initialize(target)
        path = self._find_path(signature, target.codegen())
        try:
            content = memoryview(path.read_bytes())
            if sha256(content[_DIGEST_BYTES:]).digest() == content[:_DIGEST_BYTES]:
                *kept, parts = pickle.loads(content[_DIGEST_BYTES:])  # noqa: S301  # our own file
                if kept == [path.name, signature]:
                    return _rebuild(target, *parts)
        except FileNotFoundError:
            return None
        except Exception:  # noqa: S110  # whatever is wrong with it, it can be compiled again
            pass
        with suppress(OSError):
            path.unlink()
        return None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keeps a compiled kernel, if it can be kept."""
        if result.library.has_dynamic_globals or result.reload_init:  # bound to this process
            return
        path = self._find_path(signature, result.library.codegen)
        content = dumps((path.name, signature, result._reduce()))
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, sha256(content).digest() + content)
        except OSError as error:
            _troubles.append(
                f"What was compiled for this processor cannot be kept in '{path.parent}': "
                f"{error.strerror}. Each start will compile it again."
            )

    def flush(self) -> None:
        """Forgets what was compiled, before numba compiles it again."""
        for path in Path(self.cache_path).glob(f"{self._name}.*.nbc"):
            with suppress(OSError):
                path.unlink()

    def _find_path(self, signature: Any, codegen: Any) -> Path:
        machine = (platform.python_version(), numba.__version__, *codegen.magic_tuple())
        key = sha256(repr((str(signature), machine)).encode()).hexdigest()[:16]
        return Path(self.cache_path, f"{self._name}.{key}.nbc")


class _KeptLibrary(JITCodeLibrary):  # type: ignore[misc]  # numba has no types
    """Machine code of a kept kernel, and the bitcode that it was compiled from.

    numba parses the bitcode with each kernel that it loads. Here that waits until another kernel is
    compiled that calls this one; a warm start compiles none.
    """

    _shared_module: Any

    def __init__(self, codegen: Any, name: str, machine_code: bytes, bitcode: bytes) -> None:
        super().__init__(codegen, name)
        self._bitcode = bitcode
        self.enable_object_caching()
        self._set_compiled_object(machine_code)
        self._finalize_final_module()

    def get_pointer_to_function(self, name: str) -> int:
        # numba first looks the name up among those of the bitcode.
        return int(self.codegen._engine.get_function_address(name))

    def _get_module_for_linking(self) -> Any:
        if self._shared_module is None:
            self._shared_module = ll.parse_bitcode(self._bitcode)
        return self._shared_module


def _rebuild(
    target: Any,
    code: tuple[str, str, tuple[bytes, bytes]],
    description: Any,
    environment: Any,
    *others: Any,
) -> CompileResult:
    """Returns a kernel of what ``CompileResult._reduce`` made of it, as ``_rebuild`` there does."""
    signature, objectmode, lifted, type_annotation, reload_init, referenced_envs = others
    name, _, parts = code
    library = _KeptLibrary(target.codegen(), name, *parts)
    entry_point = target.get_executable(library, description, environment)
    for each in referenced_envs:
        library.codegen.set_env(each.env_name, each)
    return compile_result(
        target_context=target,
        typing_context=target.typing_context,
        library=library,
        environment=environment,
        entry_point=entry_point,
        fndesc=description,
        type_annotation=type_annotation,
        signature=signature,
        objectmode=objectmode,
        lifted=lifted,
        reload_init=reload_init,
        referenced_envs=referenced_envs,
    )


@cache
def _find_folder(beside: Path) -> Path:
    """Returns where the kernels of a folder are kept.

    That is in ``NUMBA_CACHE_DIR``, beside their source or in the person's own cache, whichever can
    be written. If none can, it is the first that is asked for: it may hold what fits.

    Args:
        beside: the folder of their source.
    """
    name = f"{beside.name}_{sha1(str(beside).encode(), usedforsecurity=False).hexdigest()}"
    chosen = numba.config.CACHE_DIR
    places = [Path(chosen, name)] if chosen else []
    places.append(beside / "__pycache__")
    personal = Path(os.environ.get("XDG_CACHE_HOME", ""))
    if not personal.is_absolute():
        with suppress(RuntimeError):  # nobody knows the home
            personal = Path("~/.cache").expanduser()
    if personal.is_absolute():
        places.append(personal / "neurotouch" / name)
    return next(filter(_is_writable, places), places[0])


def _is_writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


@cache
def _remove_others(folder: Path, stem: str, state: str) -> None:
    """Removes what a file's kernels were compiled to in other states of the package."""
    for path in folder.glob(f"{stem}.*.nb[ci]"):
        if f"-{state}." not in path.name:
            with suppress(OSError):  # a folder of another user, or another process was quicker
                path.unlink()
