"""Plays so many pictures into the pad, and counts them at both ends of the way."""

import multiprocessing
import os
import time
from functools import partial
from pathlib import Path
from threading import Event
from typing import Any

from neurotouch_hid.driver import Driver, DriverOptions
from neurotouch_hid.messages import Step
from neurotouch_hid.source.video.live import VideoCameraSource
from tests.kernel.guest import uvc

N_PICTURES = int(os.environ.get("NEUROTOUCH_PICTURES", "150"))
"""7,500 are a minute at 125 pictures a second. A guest without KVM needs a quarter of an hour for
them, so the usual tests send fewer."""

PATIENCE_S = 120.0 + N_PICTURES


def play(results: Path) -> dict[str, Any]:
    """Plays until the camera has sent enough pictures; where each of them has gone."""
    ours, theirs = multiprocessing.Pipe()
    cameras = multiprocessing.get_context("fork").Process(target=uvc.serve, args=(theirs, results))
    cameras.start()
    options = DriverOptions(
        source="video:", profile="spacecraft", device="uinput", speed="max", listens=False
    )
    try:
        uvc.tell(ours, "plug")
        uvc.wait_for(uvc.list_nodes)
        with Driver(options) as driver:
            stop, due_s = Event(), time.monotonic() + PATIENCE_S
            asked_s, n_before, n_played = 0.0, 0, 0

            def look() -> None:
                nonlocal asked_s, n_before
                if time.monotonic() - asked_s < 1.0:
                    return
                asked_s = time.monotonic()
                n_sent = uvc.tell(ours, "count")[0]
                if not n_played:  # the gel is still searched, which takes some seconds here
                    n_before = n_sent
                if n_sent - n_before >= N_PICTURES or asked_s > due_s:
                    stop.set()

            def note(step: Step) -> None:
                nonlocal n_played
                n_played += step.gel.is_found and len(step.packet.frames)

            begun_s = time.monotonic()
            driver.run([note], stop=stop, on_round=look)
            seconds = time.monotonic() - begun_s
            source = driver.source
            assert isinstance(source, VideoCameraSource)
            orders = (partial(uvc.tell, ours, order) for order in ("slow down", "end"))
            stats = uvc.finish(source, *orders)
            n_sent, n_not_sent = uvc.tell(ours, "count")
    finally:
        cameras.kill()
    return {
        "n_sent": n_sent,
        "n_not_sent": n_not_sent,
        "n_read": stats.n_pictures,
        "n_lost": stats.n_lost,
        "n_damaged": stats.n_damaged,
        "seconds": seconds,
        "n_played": n_played,
    }
