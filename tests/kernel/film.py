"""Films gestures for an emulated UVC camera: ``python -m tests.kernel.film FILM.npy``.

The slow guest only shows the pictures. What it compiles is compiled here.
"""

import sys

import cv2
import numpy as np
from neurotouch_devtools.emulator.uvc.filming import film_script

from neurotouch_hid.source import open_source
from neurotouch_hid.source.simulator import StrokeTiming, pinch, push, sequence
from neurotouch_hid.tracker.gel_finder import GelFinder

SIZE = (320, 240)
TIMING = StrokeTiming(attack_us=400_000, hold_us=200_000, release_us=400_000)
STROKES = (push(0.0, 10.0, timing=TIMING), pinch(7.0, timing=TIMING))
TAKEN = 4
"""One of so many pictures is shown: the guest is slow."""


def main() -> None:
    film = film_script(sequence("some gestures", *STROKES, rest_us=400_000, gap_us=150_000))
    shown = film.pictures[::TAKEN]
    small = [cv2.resize(picture, SIZE, interpolation=cv2.INTER_AREA) for picture in shown]
    np.save(sys.argv[1], np.stack(small))
    with open_source("video:", finder=GelFinder(), wait=True):
        pass  # it has loaded its kernels


if __name__ == "__main__":
    main()
