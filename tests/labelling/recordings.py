"""A recording of one simulated person who makes all gestures, one after the other."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from neurotouch_hid.messages import Truth
from neurotouch_hid.recording import RecordingWriter, Simulation, write_labels
from neurotouch_hid.source.simulator import Script
from neurotouch_hid.source.simulator.dataset import KINDS, SLICE_US
from neurotouch_hid.source.simulator.simulated_people import draw_stroke, meet_person
from neurotouch_hid.source.simulator.simulator import Simulator


def write_recording(path: Path, seconds: float, seed: int) -> list[Truth]:
    """Writes a SIMULATED recording, and beside it the truth as the labels of ``truth``."""
    person, config = meet_person(seed)
    rng = np.random.default_rng(seed)
    t_us, strokes = 700_000, []
    while t_us < seconds * 1e6:
        stroke = draw_stroke(KINDS[rng.integers(len(KINDS))], rng, person)
        strokes.append(replace(stroke, start_us=t_us))
        t_us = strokes[-1].end_us + int(rng.uniform(150_000, 500_000))
    script = Script("mixed", tuple(strokes), round(seconds * 1e6))
    truths: list[Truth] = []
    with (
        RecordingWriter(path, simulation=Simulation("tests", "sim:mixed", seed=seed)) as writer,
        Simulator(script, config, seed=seed, slice_us=SLICE_US) as simulator,
    ):
        for packet in simulator:
            writer.write(packet)
            truths += [simulator.truth(t_us) for t_us in simulator.find_labelled_times(packet)]
    write_labels(path.with_name(f"{path.stem}.truth.labels.csv"), truths)
    return truths
