"""False gestures of a gel at rest before a webcam: mains light, auto exposure, a bumped table.

    python tests/benchmarks/video_rest.py FPS SEED [direct|view]

Ten minutes in ten pieces with a set-up each; light of mains=40, auto-exposure=90, and a bump of 0.3
to 3 mm after 18 s. The light of 5 s around the bump is simulated; the still times before and after
it repeat. Noise and auto exposure are computed for each frame, as ``UvcSensor`` does. ``view`` goes
through a picture of 640x480 pixels, as a camera's pictures do.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame, GestureKind
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source.simulator import Script, Simulator, uvc
from neurotouch_hid.source.simulator.kernels.optics import average_rows
from neurotouch_hid.source.simulator.sensor import TICK_US
from neurotouch_hid.source.simulator.simulated_people import meet_person
from neurotouch_hid.source.video.source import PictureSlicer
from neurotouch_hid.tracker import GelFinder

BUMPS_MM = (0.3, 0.5, 0.8, 1.0, 1.5, 2.0, 3.0, 1.0, 2.0, 0.5)
PIECE_US, BUMP_US = 60_000_000, 18_000_000
SIMULATED_US, BEFORE_US, AFTER_US = 5_000_000, 1_400_000, 4_800_000  # it bumps at 1.5 s
FLICKER_US = 10_000
NOTHING = np.empty(0, EVENT_DTYPE)


def simulate_light(fps, seed, piece):
    """Returns the sensor, and the light (n, 260, 346) float32 of each frame of five seconds."""
    lights = []

    def take_light(sensor, start_us):
        light = np.empty((260, 346))
        first = start_us // TICK_US % len(sensor._ticks)
        average_rows(sensor._weights, sensor._ticks, first, light)
        lights.append(light.astype(np.float32))
        return Frame(np.zeros((260, 346), np.uint8), start_us, start_us)

    uvc.UvcSensor._take_frame = take_light
    _, config = meet_person(90_000 + 100 * seed + piece)
    script = Script("rest", (), SIMULATED_US)
    nuisances = {"uvc": fps, "mains": 40.0, "auto-exposure": 90.0, "bump": BUMPS_MM[piece]}
    with Simulator(script, config, nuisances=nuisances, seed=1000 * seed + piece) as simulator:
        for _ in simulator:
            pass
        return simulator._sensor, lights


def expose(sensor, lights, rng):
    """Yields the frames of a piece: its light with noise and auto exposure."""
    config, settings = sensor._config, sensor._uvc
    cycle = int(np.lcm(config.frame_us, FLICKER_US)) // config.frame_us
    before, after, bump = (
        t_us // config.frame_us // cycle * cycle for t_us in (BEFORE_US, AFTER_US, BUMP_US)
    )
    pool = rng.standard_normal(6_000_000, np.float32)
    each = (config.frame_gain * sensor._gain).astype(np.float32)
    gain = 1.0
    for i in range(PIECE_US // config.frame_us):
        k = before - cycle + i % cycle if i < bump else before + i - bump
        light = lights[k] if k < after else lights[after - cycle + (k - after) % cycle]
        at = int(rng.integers(0, len(pool) - light.size))
        noise = pool[at : at + light.size].reshape(light.shape)
        sigma = np.sqrt(np.float32(config.read_noise_dn**2) + light / uvc.ELECTRONS_PER_DN)
        linear = np.float32(gain) * (each * light + sigma * noise) + sensor._offset
        pixels = np.rint(np.clip(linear, 0.0, 255.0)).astype(np.uint8)
        change = settings.auto_exposure_dn / max(float(pixels.mean()), 1.0)
        gain = min(max(gain * change**uvc.SERVO, uvc.LEAST_GAIN), uvc.MOST_GAIN)
        begin_us = i * config.frame_us
        yield Frame(pixels, begin_us, begin_us + config.exposure_us)


def cut(frames, mode):
    """Yields the packets of some frames."""
    slicer, t_us = PictureSlicer(GelFinder(), 8_000), 0
    for frame in frames:
        begin_us, end_us = frame.exposure_begin_us, frame.exposure_end_us
        if mode == "view":
            yield from slicer.push(uvc.enlarge(frame.pixels), begin_us, end_us)
        else:
            yield EventPacket(t_us, end_us + 1, NOTHING, (frame,))
            t_us = end_us + 1


def main():
    fps, seed, mode = float(sys.argv[1]), int(sys.argv[2]), (sys.argv[3:] or ["view"])[0]
    total = 0
    for piece, bump_mm in enumerate(BUMPS_MM):
        sensor, lights = simulate_light(fps, seed, piece)
        pipeline = Pipeline.build(load_profile("spacecraft"), GestureConfig())
        n_false, n_rest, largest_mm, before = 0, 0, 0.0, GestureKind.NONE
        for packet in cut(expose(sensor, lights, np.random.default_rng((seed, piece))), mode):
            step = pipeline.advance(packet)
            kind = step.gesture.kind
            n_false += kind is not GestureKind.NONE and before is GestureKind.NONE
            n_rest += step.rest is not None
            largest_mm, before = max(largest_mm, step.gesture.intensity_mm), kind
        total += n_false
        n_frames = PIECE_US // sensor._config.frame_us
        print(
            f"piece {piece}, bump {bump_mm} mm: {n_false} false gestures, at most"
            f" {largest_mm:.2f} mm, rest in {n_rest / n_frames:.1%} of frames",
            flush=True,
        )
    print(f"{fps:g} frames/s, seed {seed}, {mode}: {total} false gestures in ten minutes")


if __name__ == "__main__":
    main()
