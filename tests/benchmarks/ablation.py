"""What each part of ``method: neurotouch`` buys: a table of the notebook on recognition.

Run by hand:

    python tests/benchmarks/ablation.py

Each variant is a copy of the package with one line changed. The markers come from two models of the
gel that share no code, with the noise of a tracker but without events: the simulator's, and the
closed forms of ``tests/gesture/elastic.py``.
"""

import pickle
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
SLICE_US = 10_000
VARIANTS = {
    "everything": (),
    "no press": (("elastic/kernels/fit.py", "PRESS_MM = 1.5", "PRESS_MM = 1e-3"),),
    "no motion of everything": (
        ("elastic/kernels/fit.py", "OFFSET_MM = 0.2", "OFFSET_MM = 1e-4"),
        ("elastic/kernels/fit.py", "SWAY_RAD = 0.01", "SWAY_RAD = 1e-6"),
    ),
    "no finite turns": (
        ("elastic/kernels/columns.py", "bend = math.sqrt(", "bend = 0.0 * math.sqrt("),
        ("elastic/kernels/columns.py", "2, 0.0)) - 1.0", "2, 0.0))"),
    ),
    "contacts at lattice points": (
        ("elastic/kernels/fit.py", "STEP_MM = 2.0", "STEP_MM = 1e-3"),
    ),
    "one radius for all": (("elastic/kernels/fit.py", "RADIUS_MM = 0.8", "RADIUS_MM = 1e-3"),),
    "a finger once found stays": (
        ("elastic/fingers.py", "keep: float = 0.6", "keep: float = -1e9"),
    ),
    "no second look while forming": (
        ("elastic/kernels/search.py", "is_warm or (is_second and forming", "is_warm or (False"),
    ),
    "push compared one to one": (
        ("elastic/kernels/motion.py", "COMMON_GAIN = 1.6", "COMMON_GAIN = 1.0"),
    ),
    "type of each slice alone": (
        ("elastic/kind_rules.py", "memory_us: int = 60_000", "memory_us: int = 1"),
        ("elastic/kind_rules.py", "latch_mm: float = 2.0", "latch_mm: float = 1e9"),
    ),
    "types from all of the motion": (
        ("elastic/kernels/motion.py", "LANDING_SHARE = 0.8", "LANDING_SHARE = 0.0"),
    ),
    "all gestures end at one size": (
        ("elastic/kind_rules.py", "least_off_mm: float = 0.18", "least_off_mm: float = 0.28"),
    ),
    "fingers join those that let go": (
        ("elastic/kernels/search.py", "if not falling:", "if True:"),
    ),
    "gel that was let go is still": (
        ("elastic/kind_rules.py", "swing: float = 0.1", "swing: float = 0.0"),
    ),
    "one finger at most": (("elastic/fingers.py", "most: int = MOST", "most: int = 1"),),
    "method: paper": (("config.py", 'method: str = "neurotouch"', 'method: str = "paper"'),),
}  # fmt: skip


def make_scenes():
    """Two lists of scenes: (rest_px, [(t_us, position_px, Truth)])."""
    sys.path.insert(0, str(ROOT))
    return {"simulator": list(_simulated()), "closed forms": list(_closed_forms())}


def _simulated():
    from neurotouch_hid.source.simulator.dataset import KINDS, draw_script
    from neurotouch_hid.source.simulator.simulated_people import meet_person
    from neurotouch_hid.source.simulator.simulator import Simulator

    for user in range(3):
        person, config = meet_person(9000 + user)
        for kind in KINDS:
            rng = np.random.default_rng((9, user, kind))
            script = draw_script("ablation", kind, 6_000_000, person, rng)
            simulator = Simulator(script, config)  # its truth is cheap; its events are not made
            times = range(SLICE_US, 6_000_000, SLICE_US)
            truths = [simulator.truth(t_us) for t_us in times]
            yield _track(simulator.truth(0).markers_px, truths, rng)


def _closed_forms():
    from neurotouch_hid.geometry import PAPER_GEL
    from neurotouch_hid.messages import GestureKind, Truth
    from tests.gesture.elastic import RIG, random_scene

    rng = np.random.default_rng(9)
    for _ in range(8):
        for kind in list(GestureKind)[1:]:
            scene, truths = random_scene(rng, kind), []
            for i in range(160):
                moved, contacts, size = scene.at(i / 100)
                seen = kind if size >= 0.3 else GestureKind.NONE
                points = RIG.to_px(contacts) if size >= 0.3 else np.zeros((0, 2))
                markers = RIG.to_px(PAPER_GEL.points_mm + moved)
                truths.append(Truth((i + 1) * SLICE_US, seen, points, size, markers))
            yield _track(RIG.to_px(PAPER_GEL.points_mm), truths, rng)


def _track(rest_px, truths, rng):
    """What a tracker would say: 0.2 px of noise, correlated over 30 ms."""
    noise, steps = np.zeros(rest_px.shape), []
    for truth in truths:
        noise = 0.7 * noise + rng.normal(0, 0.2 * np.sqrt(1 - 0.7**2), noise.shape)
        steps.append((truth.t_us, (truth.markers_px + noise).astype(np.float32), truth))
    return np.asarray(rest_px, np.float32), steps


def measure(scenes):
    """One row: type, type from 2.5 mm, count, distance, intensity error."""
    from neurotouch_hid.evaluation.accuracy import Tally, summarise
    from neurotouch_hid.geometry import fit_rig
    from neurotouch_hid.gesture import GestureRecognizer
    from neurotouch_hid.messages import MarkerField

    tally, strong = Tally(), []
    for rest_px, steps in scenes:
        recognizer, rig = GestureRecognizer(), fit_rig(rest_px)
        for t_us, position_px, truth in steps:
            field = MarkerField(t_us, rest_px, position_px, np.ones(len(rest_px), bool))
            gesture = recognizer.update(field)
            tally.add_gesture(gesture, truth, rig)
            if truth.intensity_mm >= 2.5:
                strong.append(gesture.kind is truth.kind)
    found = summarise(tally)
    return (
        f"{100 * found['gesture_accuracy']:.1f} | {100 * np.mean(strong):.1f}"
        f" | {100 * found['count_accuracy']:.1f} | {found['distance_mm']:.2f}"
        f" | {found['intensity_mae_mm']:.2f}"
    )


def main():
    if len(sys.argv) == 2:  # a variant: its package comes first on the path
        scenes = pickle.loads(Path(sys.argv[1]).read_bytes())
        print(" | ".join(measure(part) for part in scenes.values()))
        return
    with tempfile.TemporaryDirectory() as folder:
        prepared = Path(folder) / "scenes.pickle"
        prepared.write_bytes(pickle.dumps(make_scenes()))
        package = Path(folder) / "neurotouch_hid"
        # Compiled loops are kept with the copies; those of a changed file are compiled anew.
        shutil.copytree(ROOT / "neurotouch_hid", package)
        for name, changes in VARIANTS.items():
            copy = Path(folder) / name.replace(" ", "-").replace(":", "")
            shutil.copytree(package, copy / "neurotouch_hid")
            for path, old, new in changes:
                file = copy / "neurotouch_hid/gesture" / path
                text = file.read_text()
                if old not in text:
                    raise SystemExit(f"{name}: '{old}' is no longer in {path}.")
                file.write_text(text.replace(old, new, 1))
            command = [sys.executable, __file__, str(prepared)]
            row = subprocess.run(
                command, env={"PYTHONPATH": str(copy)}, capture_output=True, text=True, check=True
            )
            print(f"| {name} | {row.stdout.strip()} |", flush=True)


if __name__ == "__main__":
    main()
