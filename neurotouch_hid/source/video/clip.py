"""A video clip as a source, mirrored back if its rig file says that the camera saw it mirrored."""

import logging
from collections.abc import Iterator
from pathlib import Path

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import RecordingError
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.recording import Clip, Picture
from neurotouch_hid.source.rig_file import RigFile, load_rig_file, rig_path
from neurotouch_hid.source.video.source import PictureSlicer
from neurotouch_hid.source.video.view_search import GelFinder
from neurotouch_hid.source.view import View

_log = logging.getLogger(__name__)


class ClipReplay(Closing):
    """Plays a clip as fast as it is asked for; each iteration starts at its beginning.

    A clip that is cut off plays up to the break, then raises.

    Args:
        path: the clip; ``NAME.rig.yaml`` beside it is read if there is one.
        finder: finds the gel; without, each frame shows the whole picture.
        slice_us: length of a slice.

    Attributes:
        name: ``file:`` and the path.
        rig: None: where the gel is follows from the pictures.
        is_simulated: the clip is marked so.

    Raises:
        RecordingError: the clip or its rig file cannot be used.
    """

    is_live = False
    rig: Rig | None = None

    def __init__(
        self, path: Path | str, finder: GelFinder | None, *, slice_us: int = 10_000
    ) -> None:
        self.name = f"file:{path}"
        self._clip = Clip(path)
        self.is_simulated = self._clip.simulation is not None
        beside = rig_path(path)
        known = load_rig_file(beside) if beside.exists() else RigFile()
        if known.rig is not None:
            raise RecordingError(
                f"{beside}: only 'mirrored' applies to a video; the rest is found in it.",
                hint="Remove centre_px, px_per_mm and rotation_deg.",
            )
        self._mirrored = known.mirrored
        self._finder, self._slice_us = finder, slice_us
        self._slicer = self._make_slicer()

    @property
    def view(self) -> View | None:
        """The present view of the gel; None before the first picture."""
        return self._slicer.view

    def __iter__(self) -> Iterator[EventPacket]:
        self._slicer = slicer = self._make_slicer()
        for picture in self._clip:
            yield from slicer.push(
                picture.pixels, picture.exposure_begin_us, picture.exposure_end_us
            )
        for n, why in (
            (self._clip.n_left_out, "were not later than the one before"),
            (slicer.n_doubled, "repeated the one before"),
        ):
            if n:
                _log.warning("%s: %d pictures %s and were left out.", self.name, n, why)

    def pictures(self) -> Iterator[Picture]:
        """Yields the pictures of the clip as they are."""
        return iter(self._clip)

    def close(self) -> None:
        """Does nothing: nothing stays open between two iterations."""

    def _make_slicer(self) -> PictureSlicer:
        return PictureSlicer(self._finder, self._slice_us, mirrored=self._mirrored)
