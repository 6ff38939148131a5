"""Stage 3: marker positions in, gestures out."""

from neurotouch_hid.gesture.config import GestureConfig
from neurotouch_hid.gesture.method import GestureMethod, list_methods
from neurotouch_hid.gesture.recognizer import GestureRecognizer

__all__ = ["GestureConfig", "GestureMethod", "GestureRecognizer", "list_methods"]
