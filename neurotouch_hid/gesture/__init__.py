"""Stage 3: turns marker positions into gestures."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from neurotouch_hid.gesture.config import GestureConfig
    from neurotouch_hid.gesture.method import GestureMethod, list_methods
    from neurotouch_hid.gesture.recognizer import GestureRecognizer

__all__ = ["GestureConfig", "GestureMethod", "GestureRecognizer", "list_methods"]

_MODULES = {
    "GestureConfig": "config",
    "GestureMethod": "method",
    "GestureRecognizer": "recognizer",
    "list_methods": "method",
}
"""The module of each name; it is loaded at the first use of the name. Recognising needs compiled
kernels, but 'neurotouch session' needs only a limit."""


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
