"""A soft gel with printed dots, seen by an event camera, becomes a standard game controller.

    from neurotouch_hid import open_gel

    with open_gel("sim:tour") as gel:
        for touch in gel:
            print(touch.kind, touch.intensity_mm, touch.contacts_mm)

The names in ``__all__`` follow semantic versioning: within a major version none is removed and none
changes its meaning. A name that will go warns for at least one minor version before.
"""

from importlib import import_module

# As ``typing.TYPE_CHECKING``, without importing ``typing``: until the command line can handle
# Ctrl-C, every millisecond of imports is one in which Ctrl-C prints a traceback.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from neurotouch_hid.driver import Driver, DriverOptions
    from neurotouch_hid.errors import NeuroTouchError
    from neurotouch_hid.gel import Gel, Touch, open_gel
    from neurotouch_hid.profile import load_profile

__version__ = "0.1.0"

__all__ = [
    "Driver",
    "DriverOptions",
    "Gel",
    "NeuroTouchError",
    "Touch",
    "__version__",
    "load_profile",
    "open_gel",
]

_MODULES = {
    "Driver": "driver",
    "DriverOptions": "driver",
    "Gel": "gel",
    "NeuroTouchError": "errors",
    "Touch": "gel",
    "load_profile": "profile",
    "open_gel": "gel",
}
"""The module of each name; it is loaded at the first use of the name, so that a program that only
reads a running driver loads no compiled loops."""


def __getattr__(name: str) -> "Any":
    if name not in _MODULES:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
