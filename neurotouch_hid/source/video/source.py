"""Turns grey pictures with stamps into packets without events."""

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.messages import (
    EVENT_DTYPE,
    SENSOR_HEIGHT_PX,
    SENSOR_WIDTH_PX,
    EventPacket,
    Frame,
)
from neurotouch_hid.source.slicer import Slicer
from neurotouch_hid.source.video.view_search import GelFinder, ViewSearch
from neurotouch_hid.source.view import View, ViewTable, whole_view

SEARCH_US: Final = (500_000, 100_000)
"""Time between two searched pictures, usually and at the start."""
CHECK_US: Final = 2_000_000
"""Time between two looks whether the gel is still in its view."""
_MOST_DOUBLED: Final = 3
"""Repetitions of one picture that are left out in a row; a still picture without any noise goes
on after them."""


class PictureSlicer:
    """Cuts pictures into slices; the view is found on the way.

    The slice in which a picture's exposure ends has it as its frame, and comes at once: nothing
    else can happen in it. Until the gel is found, only pictures that are searched become
    frames, some in each second. So no later stage learns a gel whose place in the picture
    is about to change. A picture that is the same as the one before, bit for bit, is left out:
    a camera has sent it twice, and it would show that nothing moves.

    Args:
        finder: finds the gel; without, the view stays that of the whole picture.
        slice_us: length of a slice.
        mirrored: the pictures show the gel mirrored.

    Attributes:
        n_doubled: pictures that were left out because they repeated the one before.
    """

    def __init__(
        self,
        finder: GelFinder | None,
        slice_us: int,
        *,
        mirrored: bool = False,
    ) -> None:
        self._finder, self._mirrored = finder, mirrored
        self._slice_us = slice_us
        self._slicer = Slicer(slice_us)
        self._table: ViewTable | None = None
        self._search: ViewSearch | None = None
        self._searched_us: int | None = None
        self._newest: NDArray[np.uint8] | None = None
        self._n_same = self.n_doubled = 0

    @property
    def view(self) -> View | None:
        """The present view; None before the first picture."""
        return None if self._table is None else self._table.view

    @property
    def is_found(self) -> bool:
        """True once the view of the gel is known."""
        return self._search is not None and self._search.is_found

    def push(
        self, pixels: NDArray[np.uint8], exposure_begin_us: int, exposure_end_us: int
    ) -> Iterator[EventPacket]:
        """Takes a picture and yields the slices up to the end of its exposure.

        Args:
            pixels: (h, w) uint8; may change afterwards. With another size than before, the
                gel is searched again.
            exposure_begin_us: start of its exposure, later than that of the picture before.
            exposure_end_us: end of its exposure; equal to the start where it is unknown.
        """
        frame = self._make_frame(pixels, exposure_begin_us, exposure_end_us)
        yield from self._slicer.push(np.empty(0, EVENT_DTYPE), () if frame is None else (frame,))
        yield from self._slicer.reach(exposure_end_us + self._slice_us)

    def reach(self, now_us: int) -> Iterator[EventPacket]:
        """Yields the slices that end at or before ``now_us``."""
        return self._slicer.reach(now_us)

    def _make_frame(self, pixels: NDArray[np.uint8], begin_us: int, end_us: int) -> Frame | None:
        table = self._table
        if table is None or pixels.shape != (table.view.height_px, table.view.width_px):
            height_px, width_px = pixels.shape
            table = ViewTable(whole_view(width_px, height_px, mirrored=self._mirrored))
            self._search = None if self._finder is None else ViewSearch(self._finder, table)
            self._searched_us = None
        if (search := self._search) is not None:
            after_us = CHECK_US if search.is_found else SEARCH_US[search.is_eager]
            waits = self._searched_us is not None and end_us < self._searched_us + after_us
            if not waits or search.is_promising:
                self._searched_us = end_us
                search.update(pixels)
            elif not search.is_found:
                return None
            table = search.table
        self._table = table
        canonical = np.empty((SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX), np.uint8)
        table.draw(pixels, canonical)
        if self._is_doubled(canonical):
            return None
        return Frame(canonical, begin_us, end_us)

    def _is_doubled(self, canonical: NDArray[np.uint8]) -> bool:
        """Returns whether a picture only repeats the newest one."""
        before, self._newest = self._newest, canonical
        # A comparison of the bytes ends at the first that differs, which noise makes soon.
        is_same = before is not None and before.data == canonical.data
        self._n_same = self._n_same + 1 if is_same else 0
        if self._n_same % (_MOST_DOUBLED + 1) == 0:
            return False
        self.n_doubled += 1
        return True
