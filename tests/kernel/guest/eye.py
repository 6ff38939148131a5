"""Plugs in an emulated PS3 Eye, which the kernel's driver ``gspca_ov534`` reads."""

import subprocess
import time
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from neurotouch_devtools.emulator.ps3eye import EyeCamera
from neurotouch_devtools.emulator.uvc import Film

from neurotouch_hid.messages import Frame
from neurotouch_hid.source import open_source
from neurotouch_hid.tracker.gel_finder import GelFinder
from tests.kernel.guest import uvc

N_SHOWN = 10
PICTURE_US = 100_000
"""Of the film; the camera sends 187 pictures a second, and most show the same as the one before."""


def read(results: Path) -> dict[str, Any]:
    """Reads the camera through our source, and counts on both sides."""
    subprocess.run(["modprobe", "gspca_ov534"], check=True)
    camera = EyeCamera(Film(np.load(results / "film.npy"), PICTURE_US))
    shown: list[Frame] = []
    with uvc.plugged(camera) as node:
        formats = uvc.ask(node, "--list-formats-ext")
        controls = uvc.ask(node, "--list-ctrls")
        # Without a finder: to search each picture takes longer here than the camera waits.
        with open_source("video:") as source:
            deadline = time.monotonic() + uvc.PATIENCE_S
            for packet in source.poll():
                if packet is not None and packet.frames:
                    shown += packet.frames
                if len(shown) >= N_SHOWN or time.monotonic() > deadline:
                    break
            settings = {name: camera.sensor[at] for name, at in REGISTERS.items()}
            stats = uvc.finish(source, partial(uvc.slow_down, camera), camera.end)
    finder = GelFinder()
    return {
        "formats": formats["said"],
        "controls": controls["said"],
        "n_sent": camera.n_sent,
        "n_not_sent": camera.n_lost,
        "n_shown": len(shown),
        "n_read": stats.n_pictures,
        "n_lost": stats.n_lost + stats.n_damaged,
        "mode": str(stats.mode),
        "lacking": list(stats.lacking),
        "settings": settings,
        "is_gel": any(finder.find(frame.pixels) is not None for frame in shown),
        "log": uvc.read_log("gspca") + uvc.read_log("ov534"),
    }


REGISTERS = {"automatic": 0x13, "exposure_high": 0x08, "exposure_low": 0x10, "gain": 0x00}
"""Of the sensor."""
