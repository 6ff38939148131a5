"""Stage 3: marker positions in, gestures out."""

from neurotouch_hid.gesture.config import METHODS, GestureConfig, Method
from neurotouch_hid.gesture.recognizer import GestureRecognizer

__all__ = ["METHODS", "GestureConfig", "GestureRecognizer", "Method"]
