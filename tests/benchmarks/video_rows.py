"""How well a webcam's frames are recognised: type, count, intensity, and when the gel is found.

    python tests/benchmarks/video_rows.py SEED MINUTES [ROW]...

Four people on each model of the gel make all gestures, as ``simulate --users 4 --elasticity both``
draws them, before a simulated webcam of 640x480 pixels. Each slice of 10 ms is compared as
``evaluate`` does: with the label of the picture before it. ``best`` is what a recogniser would
reach that knew the truth of each slice. ``at changes`` is the share of the wrong slices that are
less than 60 ms from a change of the truth, and ``light`` of those below 0.5 mm.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from neurotouch_hid.evaluation.accuracy.label_track import LabelTrack
from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source.simulator import uvc
from neurotouch_hid.source.simulator.dataset import plan_dataset, simulate_recipe
from neurotouch_hid.source.video.source import PictureSlicer
from neurotouch_hid.tracker import GelFinder
from tests.layouts import HEX, RINGS
from tests.room.bound import find_bound

SLICE_US, CHANGE_US, LIGHT_MM = 10_000, 60_000, 0.5
ROWS = {
    "125": (PAPER_GEL, {"uvc": 125.0}),
    "60-mjpeg": (PAPER_GEL, {"uvc": 60.0, "gamma": 2.2, "mjpeg": 70.0}),
    "60-rolling": (PAPER_GEL, {"uvc": 60.0, "rolling": 12.0, "doubled": 10.0}),
    "hex": (HEX, {"uvc": 125.0}),
    "rings": (RINGS, {"uvc": 125.0}),
    "missing": (PAPER_GEL, {"uvc": 125.0, "missing": 10.0}),
}


def play(simulator, gel, labels):
    """Yields the step of each slice; adds the labels of its pictures first."""
    slicer = PictureSlicer(GelFinder(gel), SLICE_US)
    pipeline = Pipeline.build(load_profile("spacecraft"), GestureConfig(), gel=gel)
    for packet in simulator:
        labels += [simulator.truth(t_us) for t_us in simulator.find_labelled_times(packet)]
        for frame in packet.frames:
            pixels = uvc.enlarge(frame.pixels)
            for piece in slicer.push(pixels, frame.exposure_begin_us, frame.exposure_end_us):
                step = pipeline.advance(piece)
                pipeline.process_frames(step)
                yield step
    pipeline.close()


def describe(truth):
    """Returns what can change of a truth."""
    return truth.kind, len(truth.contacts_px)


def compare(recipe, gel):
    """Returns (n, 4) of the slices of a recording, its bounds, and when the gel was found, s.

    The columns: type is right, count is right, near a change, light.
    """
    labels, gestures, found_us = [], [], None
    with simulate_recipe(recipe, gel) as simulator:
        for step in play(simulator, gel, labels):
            gestures.append(step.gesture)
            if found_us is None and np.isfinite(step.markers.rest_px).any():
                found_us = step.packet.t_end_us - labels[0].t_us
        slices = [simulator.truth(gesture.t_us) for gesture in gestures]
    track = LabelTrack(labels)
    ways = [describe(truth) for truth in slices]
    changes = [slices[i].t_us for i in range(1, len(ways)) if ways[i] != ways[i - 1]]
    rows, errors_mm = [], []
    for gesture, truth in zip(gestures, slices, strict=True):
        label = track.at(gesture.t_us)
        if label is None:
            continue
        is_near = any(abs(gesture.t_us - t_us) < CHANGE_US for t_us in changes)
        same_count = len(gesture.contacts_mm) == len(label.contacts_px)
        light = max(truth.intensity_mm, gesture.intensity_mm) < LIGHT_MM
        rows.append((gesture.kind is label.kind, same_count, is_near, light))
        if label.kind:
            errors_mm.append(abs(gesture.intensity_mm - label.intensity_mm))
    bound = find_bound(track, slices)
    bounds = (bound["type_bound"], bound["count_bound"])
    return np.array(rows), errors_mm, bounds, (found_us or np.inf) / 1e6


def main():
    seed, minutes = int(sys.argv[1]), float(sys.argv[2])
    for name in sys.argv[3:] or ROWS:
        gel, nuisances = ROWS[name]
        for model in ("half-space", "solid"):
            recipes = plan_dataset(4, minutes, seed, ("half-space", "solid"), nuisances)
            played = [compare(recipe, gel) for recipe in recipes if recipe.gel == model]
            rows = np.concatenate([rows for rows, _, _, _ in played])
            errors_mm = np.concatenate([errors for _, errors, _, _ in played])
            best = np.average([b for _, _, b, _ in played], 0, [len(r) for r, _, _, _ in played])
            found_s = max(found for _, _, _, found in played)
            right, (near, light) = rows[:, :2].mean(axis=0), rows[:, 2:].T
            wrong = ~rows[:, 0].astype(bool), ~rows[:, 1].astype(bool)
            print(
                f"{name} {model}: type {right[0]:.1%} (best {best[0]:.1%}), count {right[1]:.1%}"
                f" (best {best[1]:.1%}), intensity {errors_mm.mean():.2f} mm; wrong types"
                f" {near[wrong[0]].mean():.0%} at changes, {light[wrong[0]].mean():.0%} light;"
                f" wrong counts {near[wrong[1]].mean():.0%}, {light[wrong[1]].mean():.0%};"
                f" found within {found_s:.2f} s; {len(rows)} slices",
                flush=True,
            )


if __name__ == "__main__":
    main()
