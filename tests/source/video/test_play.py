"""A fake camera shows a simulated push; it is unplugged in the middle, and plugged in again."""

import threading
import time

from neurotouch_hid.device import MemoryDevice
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.profile import load_profile
from neurotouch_hid.recording import Clip
from neurotouch_hid.runtime import Pipeline, run_pipeline
from neurotouch_hid.source.video.live import VideoCameraSource
from neurotouch_hid.tracker import GelFinder
from tests.source.video.fake_camera import FakeCamera, FakeLinux

FPS = 60
PATIENCE_S = 120.0


def test_a_push_moves_the_stick_and_without_the_camera_the_pad_is_neutral(pushed):
    film = [picture.pixels for picture in Clip(pushed)]
    fake = FakeCamera(formats={"GREY": {(640, 480): (FPS,)}})
    fake.draw = lambda k: film[k % len(film)]
    linux, device, stop = FakeLinux(fake), MemoryDevice(), threading.Event()
    pipeline = Pipeline.build(load_profile("spacecraft"), GestureConfig(), frame_thread=True)
    deadline = time.monotonic() + PATIENCE_S
    seen = []

    def is_pushed():
        return bool(device.states) and not device.states[-1].is_neutral

    def act():
        """Unplugs the camera in the first push; ends with the second."""
        if time.monotonic() > deadline:
            stop.set()
        elif not seen and is_pushed():
            linux.unplug(0)
            seen.append("pushed")
        elif seen == ["pushed"] and source.trouble and not is_pushed():
            linux.cameras[3] = fake
            seen.append(source.trouble)
        elif len(seen) == 2 and is_pushed():
            seen.append("pushed again")
            stop.set()

    with VideoCameraSource(finder=GelFinder(), linux=linux) as source:
        run_pipeline(source, pipeline, device, stop=stop, on_round=act)
        stats = source.stats()
    assert seen == [
        "pushed",
        "The camera UVC Camera (/dev/video0) is not plugged in.",
        "pushed again",
    ]
    assert pipeline.gel.was_found
    assert stats.n_connects == 2
    assert device.states[-1].is_neutral
