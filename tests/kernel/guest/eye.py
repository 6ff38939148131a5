"""Plugs in an emulated PS3 Eye, which the kernel's driver ``gspca_ov534`` reads."""

import subprocess
import time
from pathlib import Path
from typing import Any

import numpy as np
from neurotouch_devtools.emulator.ps3eye import EyeCamera
from neurotouch_devtools.emulator.uvc import Film

from neurotouch_hid.source import open_source
from neurotouch_hid.tracker.gel_finder import GelFinder
from tests.kernel.guest import uvc

N_SHOWN = 5
PICTURE_US = 100_000
"""Of the film; the camera sends 187 pictures a second, and most show the same as the one before."""


def read(results: Path) -> dict[str, Any]:
    """Reads the camera through our source, and counts on both sides."""
    subprocess.run(["modprobe", "gspca_ov534"], check=True)
    camera = EyeCamera(Film(np.load(results / "film.npy"), PICTURE_US))
    n_shown, is_gel, finder = 0, False, GelFinder()
    with uvc.plugged(camera) as node:
        formats = uvc.ask(node, "--list-formats-ext")
        controls = uvc.ask(node, "--list-ctrls")
        with open_source("video:", finder=GelFinder()) as source:
            deadline = time.monotonic() + uvc.PATIENCE_S
            for packet in source.poll():
                if packet is not None and packet.frames:
                    n_shown += len(packet.frames)
                    is_gel |= finder.find(packet.frames[-1].pixels) is not None
                if (n_shown >= N_SHOWN and is_gel) or time.monotonic() > deadline:
                    break
            settings = {name: camera.sensor[at] for name, at in REGISTERS.items()}
            camera.end()
            stats = source.stats()
    return {
        "formats": formats["said"],
        "controls": controls["said"],
        "n_sent": camera.n_sent,
        "n_not_sent": camera.n_lost,
        "n_shown": n_shown,
        "n_read": stats.n_pictures,
        "n_lost": stats.n_lost + stats.n_damaged,
        "mode": str(stats.mode),
        "lacking": list(stats.lacking),
        "settings": settings,
        "is_gel": is_gel,
        "log": uvc.read_log("gspca") + uvc.read_log("ov534"),
    }


REGISTERS = {"automatic": 0x13, "exposure_high": 0x08, "exposure_low": 0x10, "gain": 0x00}
"""Of the sensor."""
