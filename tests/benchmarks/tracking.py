"""How far the tracked markers are from the true ones, and how often they change places.

    python tests/benchmarks/tracking.py

Three simulated scenes, with frames and without: pushes of 18 mm at 210 mm/s that press markers
together to a third of their distance, three fingers that pinch, spread and turn far, and the same
in noise of 5 Hz per pixel. A swap is a marker more than 3 px off, nearer to another one's place
than to its own, for 20 ms or longer.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.source.simulator import Finger, Simulator, SimulatorConfig, Stroke
from neurotouch_hid.source.simulator.config import SensorConfig
from neurotouch_hid.source.simulator.script import sequence
from neurotouch_hid.source.simulator.strokes import Fingertips, pinch, twist, zoom
from neurotouch_hid.tracker import BlobFinder, MarkerTracker, RestDetector

OFF_PX = 3.0
SWAP_SLICES = 2  # of 10 ms


def push_fast(n=6):
    for angle in 2.0 * np.pi * np.arange(n) / n + 0.2:
        way = np.array([np.cos(angle), np.sin(angle)])
        finger = Finger(tuple(-7.0 * way), tuple(18.0 * way))
        # Minimum jerk: the top speed is 1.875 times the mean, 210 mm/s.
        yield Stroke(GestureKind.PUSH, (finger,), 0, 161_000, 200_000, 161_000)


def move_three():
    yield pinch(8.0, Fingertips(n_fingers=3, spread_mm=15.0))
    yield zoom(7.0, Fingertips(n_fingers=3, spread_mm=9.0))
    yield twist(0.8, Fingertips(n_fingers=3))


def follow(packets, *, frames):
    """Positions (slices, 177, 2) and validity (slices, 177), NaN before the gel is found."""
    finder = BlobFinder()
    tracker, rest = MarkerTracker(finder=finder), RestDetector(finder=finder)
    fields = []
    for packet in packets:
        for answer in map(rest.update, packet.frames):
            if answer is not None and (frames or not tracker.stats().n_anchors):
                tracker.anchor(answer)
        fields.append(tracker.update(packet if frames else replace(packet, frames=())))
    return np.array([f.position_px for f in fields]), np.array([f.valid for f in fields])


def count_swaps(position_px, valid, truth_px):
    """Swaps, those shown as valid, and the longest one in slices."""
    away = np.hypot(*(position_px[:, :, None] - truth_px[:, None]).transpose(3, 0, 1, 2))
    off = np.hypot(*(position_px - truth_px).transpose(2, 0, 1)) > OFF_PX
    swapped = off & (away.argmin(axis=2) != np.arange(position_px.shape[1]))
    n = n_valid = longest = 0
    for k in range(swapped.shape[1]):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], swapped[:, k], [0]]).astype(int)))
        for begin, end in zip(edges[::2], edges[1::2], strict=True):
            if end - begin >= SWAP_SLICES:
                n, longest = n + 1, max(longest, end - begin)
                n_valid += valid[begin:end, k].any()
    return n, n_valid, longest


def main():
    scenes = (
        ("18 mm at 210 mm/s", tuple(push_fast()), 1.0),
        ("three fingers", tuple(move_three()), 1.0),
        ("three fingers, 5 Hz of noise", tuple(move_three()), 5.0),
    )
    for name, strokes, shot_hz in scenes:
        config = SimulatorConfig(sensor=SensorConfig(shot_hz=shot_hz))
        simulator = Simulator(sequence(name, *strokes), config)
        packets, truths = [], []
        for packet in simulator:
            packets.append(packet)
            truths.append(simulator.truth(packet.t_end_us).markers_px)
        for frames in (True, False):
            position, valid = follow(packets, frames=frames)
            known = np.isfinite(position).all(axis=(1, 2))
            position, valid, truth = position[known], valid[known], np.array(truths)[known]
            error = np.hypot(*(position - truth).transpose(2, 0, 1))
            n, n_valid, longest = count_swaps(position, valid, truth)
            print(
                f"{name}, {'with' if frames else 'without'} frames: median {np.median(error):.2f}, "
                f"p99 {np.percentile(error, 99):.2f} px; over {OFF_PX:.0f} px "
                f"{100 * (error > OFF_PX).mean():.2f} %; {n} swaps in {len(error) / 100:.1f} s, "
                f"{n_valid} of them shown as valid, the longest {10 * longest} ms; "
                f"{(error[-1] > OFF_PX).sum()} wrong at the end",
                flush=True,
            )


if __name__ == "__main__":
    main()
