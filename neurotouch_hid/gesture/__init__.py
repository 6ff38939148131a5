"""Stage 3: marker positions in, gestures out."""

from neurotouch_hid.gesture.recognizer import GestureConfig, GestureRecognizer

__all__ = ["GestureConfig", "GestureRecognizer"]
