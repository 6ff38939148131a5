"""Compiles kernels with numba, and keeps what another kernel that is compiled needs of them.

numba's own cache believes whatever it reads, and asks only whether the kernel's own file has
changed. Here a damaged file is compiled again, and so is a kernel that calls one that has changed.
"""

import pickle
import platform
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core import cgutils, types
from numba.core.codegen import JITCodeLibrary, ll
from numba.core.compiler import CompileResult, compile_result
from numba.core.runtime import rtsys
from numba.core.serialize import dumps
from numba.extending import lower_builtin, type_callable

from neurotouch_hid.process.c_call import call_c
from neurotouch_hid.process.kernel_files import (
    KernelFiles,
    read_checked,
    remove,
    write_checked,
)
from neurotouch_hid.process.machine_code import CannotLinkError, LinkedCode, link


@type_callable(call_c)  # type: ignore[untyped-decorator]
def _type_call(_: Any) -> Callable[..., Any]:
    """Tells numba what ``call_c`` returns."""
    return lambda _function, _args: types.int32


@lower_builtin(call_c, types.Integer, types.BaseTuple)  # type: ignore[untyped-decorator,attr-defined]
def _lower_call(context: Any, builder: Any, signature: Any, values: tuple[Any, Any]) -> Any:
    """Makes ``call_c`` in a kernel a call of C, whose arguments fill a register each."""
    function, args = values
    numbers = [
        context.cast(builder, value, kind, types.int64)
        for value, kind in zip(cgutils.unpack_tuple(builder, args), signature.args[1], strict=True)
    ]
    number = context.get_value_type(types.int64)
    kind = cgutils.ir.FunctionType(cgutils.int32_t, [number] * len(numbers))
    return builder.call(builder.inttoptr(function, kind.as_pointer()), numbers)


def make_dispatcher(
    function: Callable[..., Any], options: dict[str, Any], files: KernelFiles
) -> Any:
    """Returns numba's object for a kernel, with a cache of ours.

    Args:
        function: the kernel in Python.
        options: of ``numba.njit``.
        files: where its files are kept.
    """
    dispatcher = numba.njit(nogil=True, **options)(function)
    dispatcher._cache = KernelCache(files)
    return dispatcher


def compile_for(dispatcher: Any, args: tuple[Any, ...]) -> tuple[Any, LinkedCode | None]:
    """Returns the compiled function for the types of these arguments, and its linked code.

    There is none where it could not be used in another process.
    """
    function = dispatcher._compile_for_args(*args)
    types = tuple(dispatcher.typeof_pyval(each) for each in args)
    parts = dispatcher._cache.parts.pop(types, None)
    return function, None if parts is None else _link(*parts)


def _link(code: Any, description: Any, *environments: Any) -> LinkedCode | None:
    _, _, (machine_code, _) = code
    constants = {each.env_name: list(each.consts) for each in environments}
    if not all(isinstance(each, np.dtype) for some in constants.values() for each in some):
        return None  # anything else may need numba
    with suppress(CannotLinkError):
        return link(machine_code, description.llvm_cpython_wrapper_name, constants)
    return None


class KernelCache:
    """Cache of one kernel: numba asks it for compiled code, and gives it each new one.

    There is one file for each kernel, signature, processor model and version of Python and numba.

    Args:
        files: where they are kept.

    Attributes:
        parts: what ``link`` takes, of each kernel that was compiled or loaded, by its signature.
    """

    def __init__(self, files: KernelFiles) -> None:
        self._files = files
        self.cache_path = str(files.folder)
        self.parts: dict[Any, tuple[Any, ...]] = {}

    def load_overload(self, signature: Any, target: Any) -> Any:
        """Returns the compiled kernel, or None; what cannot be used is removed.

        Compiled code needs numba's runtime only. numba's own cache loads 60 modules more here,
        which compile what is not kept; numba loads them as soon as it has to compile.
        """
        rtsys.initialize(target)
        path = self._find_path(signature, target.codegen())
        content = read_checked(path)
        if content is not None:
            with suppress(Exception):  # whatever is wrong with it, it can be compiled again
                *kept, parts = pickle.loads(content)  # noqa: S301  # our own file
                if kept == [path.name, signature]:
                    result = _rebuild(target, *parts)
                    self._remember(signature, *parts)
                    return result
            remove(path)
        return None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keeps a compiled kernel, if it can be kept."""
        if result.library.has_dynamic_globals or result.reload_init:  # bound to this process
            return
        path = self._find_path(signature, result.library.codegen)
        parts = result._reduce()
        self._remember(signature, *parts)
        write_checked(path, dumps((path.name, signature, parts)))

    def flush(self) -> None:
        """Forgets what was compiled, before numba compiles it again."""
        for path in self._files.folder.glob(f"{self._files.name}.*.nbc"):
            remove(path)

    def _remember(
        self, signature: Any, code: Any, description: Any, environment: Any, *others: Any
    ) -> None:
        *_, referenced = others
        self.parts[signature] = (code, description, environment, *referenced)

    def _find_path(self, signature: Any, codegen: Any) -> Path:
        machine = (platform.python_version(), numba.__version__, *codegen.magic_tuple())
        return self._files.find_path((str(signature), machine), "nbc")


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
