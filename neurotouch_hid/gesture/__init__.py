"""Stage 3: turns marker positions into gestures.

A name loads its module when it is first asked for: recognising needs compiled kernels, but
'neurotouch session' needs only a limit.
"""

from typing import TYPE_CHECKING

from neurotouch_hid.lazy import load_lazily

if TYPE_CHECKING:
    from neurotouch_hid.gesture.config import GestureConfig
    from neurotouch_hid.gesture.method import GestureMethod, list_methods
    from neurotouch_hid.gesture.recognizer import GestureRecognizer
else:
    __getattr__ = load_lazily(
        __name__,
        {
            "config": "GestureConfig",
            "method": "GestureMethod list_methods",
            "recognizer": "GestureRecognizer",
        },
    )

__all__ = ["GestureConfig", "GestureMethod", "GestureRecognizer", "list_methods"]
