"""Reads a camera through a driver, as a program of its own, and writes down what came.

    python -m tests.emulator.drivers DRIVER OUT N_EVENTS N_FRAMES PATIENCE_S

It ends when so many events and frames have come, and no more after them.
"""

import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

QUIET_S = 0.5
LATE_US = 60_000_000
"""The emulated camera is in a hurry: here old slices are as good as new ones."""
Batch = tuple[list[Any], list[Any]]


def neuromorphic() -> Iterator[Batch]:
    """neuromorphic-drivers."""
    import neuromorphic_drivers

    with neuromorphic_drivers.open(iterator_timeout=0.1) as device:
        for _, packet in device:
            if packet is None:
                yield [], []
                continue
            events = packet.polarity_events
            frames = [
                (f.exposure_start_t, f.exposure_end_t, f.pixels >> 8, f.pixels & 0xFF)
                for f in packet.frames
            ]
            yield (
                [] if events is None else [events["t"], events["x"], events["y"], events["on"]],
                [(int(begin), int(end), high) for begin, end, high, low in frames if not low.any()],
            )


def dv() -> Iterator[Batch]:
    """dv-processing, the vendor's."""
    import dv_processing

    camera = dv_processing.io.camera.open()
    while camera.isRunning():
        store, frame = camera.getNextEventBatch(), camera.getNextFrame()
        events, frames = [], []
        if store is not None:
            found = store.numpy()
            events = [found["timestamp"], found["x"], found["y"], found["polarity"]]
        if frame is not None:
            exposure_us = round(frame.exposure.total_seconds() * 1e6)
            frames = [(frame.timestamp, frame.timestamp + exposure_us, frame.image)]
        elif store is None:
            time.sleep(0.005)
        yield events, frames


def own() -> Iterator[Batch]:
    """The source ``davis:``."""
    from neurotouch_hid.source.davis import DavisSource

    return poll(DavisSource(max_delay_us=LATE_US))


def events() -> Iterator[Batch]:
    """The source ``events:``, which plays through neuromorphic-drivers."""
    from neurotouch_hid.source.events.source import EventCameraSource

    return poll(EventCameraSource(max_delay_us=LATE_US))


def poll(source: Any) -> Iterator[Batch]:
    """Everything that a source of ours gives."""
    with source:
        for packet in source.poll():
            if packet is None:
                yield [], []
                continue
            found = packet.events
            yield (
                [found["t"], found["x"], found["y"], found["p"]],
                [(f.exposure_begin_us, f.exposure_end_us, f.pixels) for f in packet.frames],
            )


DRIVERS = {"neuromorphic": neuromorphic, "dv": dv, "own": own, "events": events}


def read(driver: str, n_events: int, n_frames: int, patience_s: float) -> Batch:
    """Everything that a driver says until it has said so much."""
    parts: list[Any] = []
    frames: list[Any] = []
    n_seen = 0
    begun = changed = time.monotonic()
    for events, pictures in DRIVERS[driver]():
        now = time.monotonic()
        if events and len(events[0]):
            parts.append([np.array(column, np.int64) for column in events])
            n_seen += len(events[0])
            changed = now
        if pictures:
            frames += [(begin, end, np.array(pixels)) for begin, end, pixels in pictures]
            changed = now
        enough = n_seen >= n_events and len(frames) >= n_frames
        if now - begun > patience_s or (enough and now - changed > QUIET_S):
            break
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)] if parts else []
    return columns, frames


def main() -> None:
    driver, out, n_events, n_frames, patience_s = sys.argv[1:]
    begun = time.monotonic()
    columns, frames = read(driver, int(n_events), int(n_frames), float(patience_s))
    np.savez(
        out,
        events=np.array(columns),
        times=np.array([(begin, end) for begin, end, _ in frames]),
        pixels=np.array([pixels for _, _, pixels in frames]),
    )
    print(json.dumps({"seconds": time.monotonic() - begun}))


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[2]))
    main()
