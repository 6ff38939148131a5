"""A simulated UVC camera as a source: its pictures go the way of a real camera's."""

from collections.abc import Iterator

from neurotouch_hid.closing import Closing
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.recording import Picture
from neurotouch_hid.source.simulator.simulator import Simulator
from neurotouch_hid.source.simulator.uvc import enlarge
from neurotouch_hid.source.video.source import PictureSlicer
from neurotouch_hid.source.video.view_search import GelFinder
from neurotouch_hid.source.view import View


class SimulatedVideo(Closing):
    """Plays a simulation with a UVC camera, in pictures of 640x480 pixels.

    Args:
        simulator: the simulation.
        finder: finds the gel; without, each frame shows the whole picture.
        slice_us: length of a slice.

    Attributes:
        name: ``sim:`` and the scene.
        rig: None: where the gel is follows from the pictures.
    """

    is_live = False
    is_simulated = True

    rig: Rig | None = None

    def __init__(self, simulator: Simulator, finder: GelFinder | None, slice_us: int) -> None:
        self.name = simulator.name
        self._simulator = simulator
        self._slicer = PictureSlicer(finder, slice_us)

    @property
    def view(self) -> View | None:
        """The present view of the gel; None before the first picture."""
        return self._slicer.view

    def __iter__(self) -> Iterator[EventPacket]:
        for picture in self.pictures():
            yield from self._slicer.push(
                picture.pixels, picture.exposure_begin_us, picture.exposure_end_us
            )

    def pictures(self) -> Iterator[Picture]:
        """Yields the pictures of the camera as they are."""
        for packet in self._simulator:
            for frame in packet.frames:
                yield Picture(enlarge(frame.pixels), frame.exposure_begin_us, frame.exposure_end_us)

    def close(self) -> None:
        """Does nothing: there is nothing to close."""
