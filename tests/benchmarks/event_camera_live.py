"""From the library's packets to the pad, live: share of a core, and what was dropped.

    python -m tests.benchmarks.event_camera_live [MILLION_EVENTS_PER_S] [SECONDS] [PACE] [SLICE_US]

A simulated hand pushes a simulated gel again and again before a camera of 1280x720 without frames.
Events around the dots are added up to the wanted rate. The program plays them as `run` does, in
slices that follow the activity, or of SLICE_US; the pad is one in memory. The packets are made
before and come when they are due; if the program is late, they wait as in the library, and it may
throw them away. The share is processor time, without that of the player, in a second of the camera.
On a busy machine a PACE of 0.2 lets the camera run at a fifth of its speed. The library's own
decoding is not in it.
"""

import sys
import threading
import time
from itertools import takewhile
from types import SimpleNamespace

import numpy as np

from neurotouch_hid.device import MemoryDevice
from neurotouch_hid.evaluation.speed.workload import DenseSource, LoopScene
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline, run_pipeline, warm_up
from neurotouch_hid.source.events.source import EventCameraSource
from neurotouch_hid.source.opening import LIVE_US
from neurotouch_hid.source.simulator import Simulator, StrokeTiming, push, sequence
from neurotouch_hid.source.slice_pacer import MOVING_US
from tests.source.events.fake_library import (
    Camera,
    Device,
    Library,
    list_places,
    magnify,
    make_packet,
)

PACKET_US = 1_000
SCENE_US = 800_000
STROKE = StrokeTiming(attack_us=100_000, hold_us=200_000, release_us=100_000)
FRAMES_US = 700_000  # frames show the gel before the first push, then they end
WARM_US = 2_000_000


def load_push():
    """A push, from rest to rest, in slices as long as a packet."""
    script = sequence("a push", push(0.0, 10.0, timing=STROKE), rest_us=200_000, gap_us=200_000)
    packets, markers = [], []
    with Simulator(script, slice_us=PACKET_US) as simulator:
        for packet in takewhile(lambda packet: packet.t_end_us <= SCENE_US, simulator):
            packets.append(packet)
            middle_us = packet.t_begin_us + PACKET_US // 2
            markers.append(simulator.truth(middle_us).markers_px)
    return LoopScene(tuple(packets), np.array(markers, np.float32))


def enlarge(frame, places):
    """A frame as the library gives it, in the size of the sensor."""
    pixels = frame.pixels[(places >> 16).clip(0), (places & 0xFFFF).clip(0, 345)]
    return SimpleNamespace(
        exposure_start_t=frame.exposure_begin_us,
        exposure_end_t=frame.exposure_end_us,
        t=frame.exposure_end_us,
        pixels=(pixels.astype(np.uint16) * 4) << 6,
    )


class Player(Device):
    """Gives each packet when it is due; those that are late wait, and can be thrown away."""

    def __init__(self, *parts):
        super().__init__(*parts)
        self.began_s, self.cpu_s, self.k, self.n_given, self.n_skipped = None, 0.0, 0, 0, 0

    def __next__(self):
        camera = self.camera
        if self.began_s is None:
            self.began_s = time.monotonic()
        left_s = self.began_s + camera.period_s * (self.k + 1) - time.monotonic()
        if left_s > 0.0:
            time.sleep(left_s)
        begun_s = time.thread_time()
        loops, k = divmod(self.k, len(camera.parts))
        events = camera.parts[k]
        shift_us = loops * len(camera.parts) * PACKET_US - camera.shifts_us[k]
        if shift_us:
            events["t"] += np.uint64(shift_us)
            camera.shifts_us[k] += shift_us
        frames = camera.frames[k] if PACKET_US * self.k < FRAMES_US else []
        due_s = self.began_s + camera.period_s * (self.k + 1)
        n_due = int((time.monotonic() - self.began_s) / camera.period_s)
        self.k += 1
        self.n_given += len(events)
        now = time.time()
        ring = SimpleNamespace(
            current_t=PACKET_US * self.k,
            system_time=now - max(0.0, time.monotonic() - due_s),
            backlog=max(0, n_due - self.k),
            dropped_packets=0,
        )
        self.cpu_s += time.thread_time() - begun_s
        return SimpleNamespace(system_time=now, ring=ring), make_packet(events, frames=frames)

    def clear_backlog(self, until):
        super().clear_backlog(until)
        n_due = int((time.monotonic() - self.began_s) / self.camera.period_s)
        while self.k < n_due - until:
            self.n_skipped += len(self.camera.parts[self.k % len(self.camera.parts)])
            self.k += 1


class PlayedLibrary(Library):
    """The library with a camera that is played."""

    def open(self, **options):
        device = super().open(**options)
        (camera,) = self.cameras
        camera.device = Player(camera, device.configuration, device.timeout_s)
        return camera.device


def film(million_per_s, pace):
    """A camera, and the packets that it gives in turn."""
    camera = Camera()
    camera.period_s = 1e-6 * PACKET_US / pace
    places = list_places(camera.view)
    share = np.count_nonzero(places >= 0) / len(np.unique(places[places >= 0]))
    scene = load_push()
    dense = DenseSource(scene, 1e-6 * SCENE_US, 1e6 * million_per_s / share)
    camera.parts = [magnify(packet.events, camera.view) for packet in dense]
    camera.frames = [[enlarge(f, places) for f in packet.frames] for packet in scene.packets]
    camera.shifts_us = np.zeros(len(camera.parts), np.int64)
    return camera


class Watch:
    """A tap that notes processor times, and ends the run."""

    def __init__(self, seconds):
        self.seconds, self.stop = seconds, threading.Event()
        self.begin = self.end = None
        self.kinds, self.n_events, self.n_gaps, self.device = [], 0, 0, None

    def __call__(self, step):
        now_us = step.packet.t_end_us
        if self.begin is None and now_us > WARM_US:
            self.begin = (now_us, time.process_time(), time.thread_time(), self.device.cpu_s)
        if self.begin is not None:
            self.kinds.append(step.gesture.kind)
            self.n_events += len(step.packet.events)
            self.n_gaps += step.packet.gap
            if now_us > self.begin[0] + 1e6 * self.seconds:
                self.end = (now_us, time.process_time(), time.thread_time(), self.device.cpu_s)
                self.stop.set()


def main():
    words = sys.argv[1:]
    given = dict(zip(("rate", "seconds", "pace", "slice_us"), map(float, words), strict=False))
    million_per_s, slice_us = given.get("rate", 20.0), int(given.get("slice_us", 0))
    watch = Watch(given.get("seconds", 10.0))
    camera = film(million_per_s, given.get("pace", 1.0))
    warm_up(Pipeline.build(load_profile("spacecraft"), GestureConfig()))
    pipeline = Pipeline.build(load_profile("spacecraft"), GestureConfig(), frame_thread=True)
    pad, library = MemoryDevice(), PlayedLibrary(camera)
    with EventCameraSource(
        slice_us=slice_us or LIVE_US,
        part_us=None if slice_us else MOVING_US,
        library=library,
        plugged=library.list_plugged,
    ) as source:
        watch.device = camera.device
        run_pipeline(source, pipeline, pad, [watch], stop=watch.stop)
        stats, player = source.stats(), watch.device
    (begin_us, *begun), (end_us, *ended) = watch.begin, watch.end
    seconds = 1e-6 * (end_us - begin_us)
    whole, pipe, played = (
        (after - before) / seconds for before, after in zip(begun, ended, strict=True)
    )
    pushed = sum(kind is GestureKind.PUSH for kind in watch.kinds) / len(watch.kinds)
    print(
        f"{million_per_s:g} million events/s of 1280x720 for {seconds:.1f} s: "
        f"{whole - played:.0%} of a core (pipeline {pipe:.0%}, "
        f"source {whole - played - pipe:.0%}); "
        f"{watch.n_events / seconds / 1e6:.2f} million events/s in the pipeline, "
        f"{len(watch.kinds) / seconds:.0f} slices/s, {pushed:.0%} of them a push; "
        f"thrown away {player.n_skipped} of {player.n_given + player.n_skipped} events, "
        f"said: {stats.n_cleared} times, {stats.n_lost} buffers, gaps {watch.n_gaps}"
    )


if __name__ == "__main__":
    main()
