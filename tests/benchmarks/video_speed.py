"""Processor time from a webcam's picture of 640x480 pixels to the pad, and to a gel that is found.

    python tests/benchmarks/video_speed.py [SCENE] [SECONDS]

The scene is simulated at 125 frames per second, and turned into the bytes that a camera sends.
Counted is all that the pipeline's thread does for a picture: the grey values, its place in the
canonical picture, search of the dots, tracker, gesture, profile and rest. What waits, does not
count: the machine may be busy. The pad is written to nowhere.
"""

import sys
import time
from pathlib import Path

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source import open_source
from neurotouch_hid.source.simulator import uvc
from neurotouch_hid.source.video.capture import PictureFormat
from neurotouch_hid.source.video.formats import GreyReader
from neurotouch_hid.source.video.source import PictureSlicer
from neurotouch_hid.tracker import GelFinder

FPS, WARM = 125.0, 125


def encode(pixels, fourcc):
    """Returns the bytes that a camera sends for a grey picture."""
    if fourcc == "MJPG":
        return cv2.imencode(".jpg", pixels, (cv2.IMWRITE_JPEG_QUALITY, 80))[1].ravel()
    return np.stack([pixels, np.full_like(pixels, 128)], axis=2).ravel()


def watch(scene, seconds):
    """Returns the begin and the end of exposure of each picture of a scene, and the picture."""
    with open_source(f"{scene},uvc={FPS:g}", speed="max") as source:
        frames = []
        for packet in source:
            if packet.t_begin_us > 1e6 * seconds:
                return frames
            frames += [
                (f.exposure_begin_us, f.exposure_end_us, uvc.enlarge(f.pixels))
                for f in packet.frames
            ]
        return frames


def measure(frames, fourcc):
    """Returns the processor time of each picture, and until the gel was found, s."""
    reader = GreyReader(PictureFormat(fourcc, 640, 480, 1280 if fourcc == "YUYV" else 0))
    sent = [encode(pixels, fourcc) for _, _, pixels in frames]
    times_s, found_s = [], None
    pipeline = Pipeline.build(load_profile("spacecraft"), GestureConfig())
    slicer = PictureSlicer(GelFinder(), 8_000)
    for data, (begin_us, end_us, _) in zip(sent, frames, strict=True):
        begin_s = time.thread_time()
        for packet in slicer.push(reader.read(data), begin_us, end_us):
            step = pipeline.advance(packet)
            pipeline.finish(step)
        times_s.append(time.thread_time() - begin_s)
        if found_s is None and np.isfinite(step.markers.rest_px).any():
            found_s = sum(times_s)
    pipeline.close()
    return np.array(times_s), found_s


def main():
    scene, seconds = (sys.argv[1:] or ["sim:random"])[0], float((sys.argv[2:] or ["6"])[0])
    frames = watch(scene, seconds)
    for fourcc in ("YUYV", "MJPG"):
        measure(frames[:WARM], fourcc)  # loads everything
        times_s, found_s = measure(frames, fourcc)
        p50, p99 = 1e3 * np.percentile(times_s[WARM:], (50, 99))
        print(
            f"{fourcc}: p50 {p50:.2f} ms, p99 {p99:.2f} ms, {FPS * times_s[WARM:].mean():.0%} of a"
            f" core; found after {found_s:.2f} s of processor time; {len(times_s)} pictures",
            flush=True,
        )


if __name__ == "__main__":
    main()
