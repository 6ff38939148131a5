"""Opens the container that a clip's ending names; no other one is tried."""

from collections.abc import Callable
from typing import Final

from neurotouch_hid.recording.video.avi import read_avi
from neurotouch_hid.recording.video.matroska import read_matroska
from neurotouch_hid.recording.video.mp4 import read_mp4
from neurotouch_hid.recording.video.track import ClipFile, Video
from neurotouch_hid.vocabulary import CLIP_ENDINGS

_READERS: Final[dict[str, Callable[[ClipFile], Video]]] = dict(
    zip(CLIP_ENDINGS, (read_avi, read_matroska, read_mp4), strict=True)
)


def open_video(descriptor: int, ending: str) -> Video:
    """Returns the clip in an open file.

    Args:
        descriptor: of the file; must stay open as long as packets are read.
        ending: of its name, such as ``.avi``.

    Raises:
        DamageError: it has no readable head.
        OSError: the disk cannot be read.
    """
    return _READERS[ending](ClipFile(descriptor))
