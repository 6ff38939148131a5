"""Is the recognition the same if slices follow the activity, as those of a camera do?

    python tests/benchmarks/activity.py SEED MINUTES [USERS]

Simulated people and strokes are those of ``simulate --elasticity both``. Each stroke is played in
slices of 10 ms as a recording is; in 4 ms as a camera's were, joined at rest; and the same in 1 ms
while the gel moves. Every 20 ms the newest step counts: what the pad shows then.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.runtime.pipeline import IDLE_US
from neurotouch_hid.source.opening import LIVE_US, PAPER_US
from neurotouch_hid.source.simulator.dataset import REST_US, plan_dataset, simulate_recipe
from neurotouch_hid.source.slice_pacer import MOVING_US, SlicePacer
from neurotouch_hid.source.slicer import Slicer

LOOK_US = 20_000
WAYS = {"recording": (PAPER_US, None), "4 ms": (LIVE_US, None), "activity": (LIVE_US, MOVING_US)}


def play(packets, slice_us, part_us):
    """Yields the steps."""
    pipeline = Pipeline.build(load_profile("spacecraft"), GestureConfig())
    slicer, pacer, idle_us = Slicer(slice_us, 0), SlicePacer(slice_us), 0
    pacer.is_idle = None if slice_us == PAPER_US else False
    for packet in packets:
        pieces = slicer.push(packet.events, packet.frames)
        for piece in pieces:
            for whole in pacer.take(piece):
                step = pipeline.advance(whole)
                length_us = whole.t_end_us - whole.t_begin_us
                is_still = step.gesture.kind is GestureKind.NONE and step.pad.is_neutral
                idle_us = idle_us + length_us if is_still else 0
                if pacer.is_idle is not None:
                    pacer.is_idle = idle_us >= IDLE_US
                yield step
            slicer.part_us = part_us if pacer.wants_parts else None
    pipeline.close()


def look(steps, truth_at):
    """Yields (type is right, count is right, error of the intensity in mm or None)."""
    now_us, last = REST_US, None
    for step in steps:
        while last is not None and step.gesture.t_us > now_us:
            truth, gesture = truth_at(now_us), last.gesture
            error_mm = abs(gesture.intensity_mm - truth.intensity_mm) if truth.kind else None
            is_counted = len(gesture.contacts_mm) == len(truth.contacts_px)
            yield gesture.kind is truth.kind, is_counted, error_mm
            now_us += LOOK_US
        last = step


def main():
    seed, minutes = int(sys.argv[1]), float(sys.argv[2])
    users = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    shares = {way: [] for way in WAYS}
    for recipe in plan_dataset(users, minutes, seed, ("half-space", "solid")):
        with simulate_recipe(recipe) as simulator:
            packets = list(simulator)
            for way, lengths in WAYS.items():
                steps = list(play(packets, *lengths))
                types, counts, errors_mm = zip(*look(steps, simulator.truth), strict=True)
                error_mm = np.mean([each for each in errors_mm if each is not None])
                shares[way].append((np.mean(types), np.mean(counts), error_mm))
                print(
                    f"{recipe.name}, {way}: {tell(shares[way][-1])}, {len(steps)} steps", flush=True
                )
    before = np.array(shares["4 ms"])
    for way, rows in shares.items():
        off = np.array(rows) - before
        error = off.std(axis=0, ddof=1) / np.sqrt(len(off))
        print(f"{way}: {tell(np.mean(rows, axis=0))}")
        print(f"  more than with 4 ms: {tell(off.mean(axis=0))}; standard error {tell(error)}")


def tell(figures):
    return "type {:.4f}, count {:.4f}, intensity error {:.4f} mm".format(*figures)


if __name__ == "__main__":
    main()
