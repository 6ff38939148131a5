"""What the emulated cameras see in the guest; run as a program, compiles all that they need."""

import time
from itertools import count

import numpy as np
from neurotouch_devtools.emulator import CameraConfig, EmulatedCamera, Fault, Identity

from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame
from neurotouch_hid.source.davis import DavisSource

FIFO_BYTES = 1 << 26
"""More than a slow guest can be behind: what is lost is lost on purpose."""
PATIENCE_S = 120.0


def make_scene(n_slices=20, seed=1):
    """Events all over the sensor and a frame every 40 ms, each one told from all others."""
    rng = np.random.default_rng(seed)
    packets = []
    for k in range(n_slices):
        begin_us = 10_000 * k
        events = np.zeros(50, EVENT_DTYPE)
        events["t"] = np.sort(rng.integers(begin_us, begin_us + 10_000, len(events)))
        events["x"], events["y"] = rng.integers(346, size=50), rng.integers(260, size=50)
        events["p"] = rng.integers(2, size=50)
        pixels = rng.integers(256, size=(260, 346)).astype(np.uint8)
        frames = (Frame(pixels, begin_us + 2_000, begin_us + 6_000),) if k % 10 == 3 else ()
        packets.append(EventPacket(begin_us, begin_us + 10_000, events, frames))
    return packets


def flicker():
    """An event every millisecond, for ever."""
    for begin_us in count(0, 10_000):
        events = np.zeros(10, EVENT_DTYPE)
        events["t"] = begin_us + 1_000 * np.arange(10)
        yield EventPacket(begin_us, begin_us + 10_000, events, ())


def emulate(scene, *faults, serial="00000001", super_speed=True):
    """A camera whose scene begins when a guest, however slow, has started it."""
    identity = Identity(serial=serial, super_speed=super_speed)
    config = CameraConfig(identity=identity, fifo_bytes=FIFO_BYTES, await_reset=True)
    return EmulatedCamera(scene, config, [Fault.parse(fault) for fault in faults])


def compare(packets, scene):
    """Whether all events and frames are there, as the packets of a scene have them."""
    found = np.concatenate([packet.events for packet in packets])
    given = np.concatenate([packet.events for packet in scene])
    frames = [frame.pixels for packet in packets for frame in packet.frames]
    originals = [frame.pixels for packet in scene for frame in packet.frames]
    same = len(found) == len(given) and len(frames) == len(originals)
    shifts = np.unique(found["t"] - given["t"]).tolist() if len(found) == len(given) else []
    return {
        "n_events": [len(found), len(given)],
        "n_frames": [len(frames), len(originals)],
        "n_shifts": len(shifts),
        "same": same
        and all(np.array_equal(found[name], given[name]) for name in ("x", "y", "p"))
        and all(map(np.array_equal, frames, originals)),
    }


def load_kernels():
    """Play a scene with no kernel between camera and driver: compiles, or loads, all they need.

    Raises:
        TimeoutError: it does not come to its end.
    """
    from neurotouch_hid.source.events.reader import load_kernels as load_kernels_of_events
    from neurotouch_hid.source.view import whole_view
    from tests.source.davis.cable import Cable

    load_kernels_of_events(whole_view(346, 260), has_frames=True)
    camera = emulate(make_scene(4))
    deadline = time.monotonic() + PATIENCE_S
    with DavisSource(cameras=Cable(camera)) as source:
        for _ in source.poll():
            if camera.ended:
                return
            if time.monotonic() > deadline:
                raise TimeoutError(f"{source.stats()}")


if __name__ == "__main__":
    load_kernels()
