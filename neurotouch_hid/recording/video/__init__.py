"""The insides of video clips: containers, tracks, packets, and the pictures in them."""

from neurotouch_hid.recording.video.grey import CODECS, decode
from neurotouch_hid.recording.video.matroska_output import MatroskaHead, make_cluster, make_head
from neurotouch_hid.recording.video.opening import open_video
from neurotouch_hid.recording.video.riff import make_bitmap_head
from neurotouch_hid.recording.video.track import Track, Video

__all__ = [
    "CODECS",
    "MatroskaHead",
    "Track",
    "Video",
    "decode",
    "make_bitmap_head",
    "make_cluster",
    "make_head",
    "open_video",
]
