"""The same strokes seen by a DAVIS and by a webcam: what does a lack of events cost?

    python tests/benchmarks/video_pairs.py SEED MINUTES [NUISANCE=STRENGTH]...

People and strokes are those of ``simulate --users 1 --elasticity both``. The truth is that of each
step, not of the labelled frames: a camera of 25 frames/s is labelled 40 ms at a time, one of 125
frames/s 8 ms, and that changes the figures by more than the camera does. Ways: ``direct`` in the
canonical picture, ``view`` through a picture of 640x480, ``live`` with the frame thread, which gets
all the time it needs.
"""

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source.simulator import uvc
from neurotouch_hid.source.simulator.dataset import REST_US, plan_dataset, simulate_recipe
from neurotouch_hid.source.video.source import PictureSlicer
from neurotouch_hid.tracker import GelFinder

SLICE_US = 10_000
NOTHING = np.empty(0, EVENT_DTYPE)
ROWS = (("davis", "direct"), ("uvc", "direct"), ("uvc", "view"), ("uvc", "live"))


def halve(packet):
    """Yields a packet of 20 ms in two slices."""
    middle_us = packet.t_begin_us + SLICE_US
    cut = int(np.searchsorted(packet.events["t"], middle_us))
    early = tuple(frame for frame in packet.frames if frame.exposure_end_us < middle_us)
    late = packet.frames[len(early) :]
    yield EventPacket(packet.t_begin_us, middle_us, packet.events[:cut], early, packet.gap)
    yield EventPacket(middle_us, packet.t_end_us, packet.events[cut:], late)


def play(simulator, way):
    """Yields the steps."""
    pipeline = Pipeline.build(
        load_profile("spacecraft"), GestureConfig(), frame_thread=way == "live"
    )
    slicer, end_us = PictureSlicer(GelFinder(), SLICE_US), 0
    for packet in simulator:
        packets = list(halve(packet))
        if way == "view":
            pictures = [(uvc.enlarge(f.pixels), f) for f in packet.frames]
            packets = [
                piece
                for pixels, f in pictures
                for piece in slicer.push(pixels, f.exposure_begin_us, f.exposure_end_us)
            ]
        elif way == "live":
            ends_us = [end_us, *(f.exposure_end_us + 1 for f in packet.frames)]
            packets = [
                EventPacket(ends_us[k], ends_us[k + 1], NOTHING, (f,))
                for k, f in enumerate(packet.frames)
            ]
            end_us = ends_us[-1]
        for piece in packets:
            step = pipeline.advance(piece)
            pipeline.finish(step)
            while way == "live" and not pipeline.rest._results:
                time.sleep(0.0005)
            yield step
    pipeline.close()


def main():
    seed, minutes = int(sys.argv[1]), float(sys.argv[2])
    given = dict(text.split("=") for text in sys.argv[3:])
    nuisances = {"uvc": 125.0, **{name: float(strength) for name, strength in given.items()}}
    for camera, way in ROWS:
        chosen = nuisances if camera == "uvc" else {}
        types, counts, errors_mm = [], [], []
        for recipe in plan_dataset(1, minutes, seed, ("half-space", "solid"), chosen):
            with simulate_recipe(recipe) as simulator:
                for step in play(simulator, way):
                    gesture = step.gesture
                    if gesture.t_us < REST_US:
                        continue
                    truth = simulator.truth(gesture.t_us)
                    types.append(gesture.kind is truth.kind)
                    counts.append(len(gesture.contacts_mm) == len(truth.contacts_px))
                    if truth.kind:
                        errors_mm.append(abs(gesture.intensity_mm - truth.intensity_mm))
        print(
            f"{camera} {way}: type {np.mean(types):.1%}, count {np.mean(counts):.1%},"
            f" intensity {np.mean(errors_mm):.2f} mm, {len(types)} steps",
            flush=True,
        )


if __name__ == "__main__":
    main()
