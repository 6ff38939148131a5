"""Makes a start quicker, and keeps libraries from what nobody has asked for.

``tests/process/test_startup.py`` tells when one of these is no longer needed.
"""

import gc
import os
import sys
from types import ModuleType
from typing import Final

MANY_OBJECTS: Final = 100_000
"""Python looks for garbage after so many new objects, instead of after some hundred."""


def collect_rarely() -> None:
    """Makes Python look for garbage rarely while modules are loaded.

    Hardly anything becomes garbage then, yet looking for it took 0.2 s of a start.
    """
    gc.set_threshold(MANY_OBJECTS)


def leave_out_scipy() -> None:
    """Makes SciPy look as if it were not installed.

    numba loads SciPy's linear algebra where it is installed, which takes 0.2 s of every start. No
    kernel needs any of it, and nothing else here needs SciPy.
    """
    sys.modules.setdefault("scipy", None)  # type: ignore[arg-type]  # "no such module"


def leave_out_asyncio() -> None:
    """Keeps evdev from loading asyncio, and with it OpenSSL: 7 MB that no driver uses.

    evdev then offers the same without asynchronous reading. The page still gets asyncio.
    """
    sys.modules.setdefault("evdev.eventio_async", None)  # type: ignore[arg-type]  # "no such module"


def leave_out_colours() -> None:
    """Keeps numba from colouring its errors, which nobody sees.

    Where colorama is installed, numba starts it. It then writes to the terminal at our end, also to
    that of a screen reader.
    """
    os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")


def leave_out_pydantic_plugins() -> None:
    """Keeps pydantic from searching every installed package for plugins, and from running them."""
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")


def hasten_pydantic() -> None:
    """Takes a tenth off the import of pydantic.

    Also with plugins disabled it imports importlib.metadata to look for them, and with it the
    parsers of e-mail and zip files. Where it no longer looks, this does nothing.
    """
    loader = ModuleType("pydantic.plugin._loader")
    loader.get_plugins = tuple  # type: ignore[attr-defined]
    sys.modules.setdefault(loader.__name__, loader)
