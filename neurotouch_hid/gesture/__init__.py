"""Stage 3: marker positions in, gestures out."""

from neurotouch_hid.gesture.config import METHODS, GestureConfig, Method, NeutralPose
from neurotouch_hid.gesture.recognizer import GestureRecognizer

__all__ = ["METHODS", "GestureConfig", "GestureRecognizer", "Method", "NeutralPose"]
