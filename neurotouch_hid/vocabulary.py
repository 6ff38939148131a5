"""The words for gestures and for the controls of the pad; all stages and profiles use them.

Separate from the records, so that a profile can be checked without loading numpy.
"""

from enum import IntEnum, StrEnum
from pathlib import PurePath
from typing import Final, Literal

NAME_PATTERN: Final = r"^[a-z0-9_][a-z0-9_-]{0,63}$"
"""The name of a profile; never a path, and never what commands take for an option."""

PipelineState = Literal["running", "paused", "panic"]
"""Whether gestures act. Only ``resume`` ends a panic."""

Phase = Literal["attack", "hold", "release"]
"""Whether the intensity of a gesture rises, stays or falls."""

Speed = Literal["recorded", "max"]
"""How fast a source plays: as it was recorded, or as fast as possible."""

RUNNING_DRIVER: Final = "driver:"
"""The source that gives what the running driver sees."""

# The members are looked up in sets and dicts a hundred times a slice, and ``Enum`` works out their
# hash in Python; their values have the same equality and a hash in C.


class GestureKind(IntEnum):
    """Type of a gesture. Clockwise is as seen by the user. The label is the lower-case name."""

    __hash__ = int.__hash__

    NONE = 0
    PUSH = 1
    PINCH = 2
    ZOOM = 3
    TWIST_CW = 4
    TWIST_CCW = 5

    @property
    def label(self) -> str:
        """The name used in labels, traces and profiles, for example ``twist_cw``."""
        return self.name.lower()


class Button(StrEnum):
    """The buttons of the pad, by the words printed on it.

    Not the kernel's names: there ``BTN_NORTH`` is the button labelled X, which is west.
    """

    __hash__ = str.__hash__

    A = "a"
    B = "b"
    X = "x"
    Y = "y"
    LB = "lb"
    RB = "rb"
    BACK = "back"
    START = "start"
    GUIDE = "guide"
    LS = "ls"
    RS = "rs"


class Axis(StrEnum):
    """The axes of the pad: sticks and D-pad -1..1 (right and down are positive), triggers 0..1."""

    __hash__ = str.__hash__

    LEFT_X = "left_x"
    LEFT_Y = "left_y"
    RIGHT_X = "right_x"
    RIGHT_Y = "right_y"
    LEFT_TRIGGER = "left_trigger"
    RIGHT_TRIGGER = "right_trigger"
    DPAD_X = "dpad_x"
    DPAD_Y = "dpad_y"


class GelProblem(StrEnum):
    """The problems of a gel in the camera's picture; ``NONE`` is false."""

    __hash__ = str.__hash__

    NONE = ""
    WAITING = "waiting"
    NO_FRAMES = "no_frames"
    EVENTS_ONLY = "events_only"
    DARK = "dark"
    BRIGHT = "bright"
    NO_DOTS = "no_dots"
    BLURRED = "blurred"
    SMALL = "small"
    LARGE = "large"
    OUTSIDE = "outside"
    PATTERN = "pattern"
    FAINT = "faint"
    MISSING = "missing"
    GLINTS = "glints"
    IRREGULAR = "irregular"
    BENT = "bent"
    TOUCHED = "touched"
    LEARNING = "learning"
    MOVED = "moved"
    RESTS = "rests"
    FLICKER = "flicker"
    TOO_FAST = "too_fast"


CLIP_ENDINGS: Final = (".avi", ".mkv", ".mp4")
"""Endings of video clips, in lower case."""
RECORDING_ENDINGS: Final = (".aedat4", *CLIP_ENDINGS)
"""Endings of all recordings."""


class SourceKind(StrEnum):
    """Kind of a source, given by the first word of its name."""

    CAMERA = "davis"
    VIDEO = "video"
    EVENTS = "events"
    RECORDING = "file"
    SIMULATION = "sim"
    DRIVER = "driver"
    OTHER = "other"


def find_source_kind(name: str) -> SourceKind:
    """Returns the kind of a source.

    Args:
        name: as a person writes it, for example ``sim:tour``, ``play.aedat4`` or ``play.mkv``. What
            begins with a word and a colon is a source of another package, however it ends.
    """
    kind, colon, _ = name.partition(":")
    if colon and kind in ("davis", "video", "events", "file", "sim", "driver"):
        return SourceKind(kind)
    is_plugin = bool(colon) and kind.replace("-", "_").isidentifier()
    is_recording = not is_plugin and name.lower().endswith(RECORDING_ENDINGS)
    return SourceKind.RECORDING if is_recording else SourceKind.OTHER


def is_clip(name: str | PurePath) -> bool:
    """Returns whether a recording is a video clip, by its ending."""
    return str(name).lower().endswith(CLIP_ENDINGS)
