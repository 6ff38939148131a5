import json
import os
from collections import Counter
from multiprocessing import get_context

import numpy as np
import pytest

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.recording import Recording, labels_path, read_labels
from neurotouch_hid.source.simulator import dataset
from neurotouch_hid.source.simulator.gel import GelMotion
from neurotouch_hid.source.simulator.optics import CameraModel
from neurotouch_hid.source.simulator.simulated_people import meet_person


@pytest.fixture(scope="module")
def small_set(tmp_path_factory):
    folder = tmp_path_factory.mktemp("set") / "new"
    seen = []
    paths = dataset.write_dataset(folder, users=1, minutes=0.1, seed=2, progress=seen.append)
    return folder, paths, seen


def test_a_set_holds_one_recording_per_user_and_gesture(small_set):
    folder, paths, seen = small_set
    assert [path.stem for path in paths] == [f"user1-{kind.label}" for kind in dataset.KINDS]
    assert not list(folder.glob(".*"))
    assert [p.path for p in seen if p.share == 1.0] == paths
    assert all(p.n_files == 5 and 0 <= p.share <= 1 for p in seen)


def test_a_recording_is_what_its_recipe_simulates(small_set):
    _, paths, _ = small_set
    recipe = dataset.plan_dataset(1, 0.1, 2)[0]
    events = [packet.events for packet in dataset.simulate_recipe(recipe)]
    read = [batch for batch, _ in Recording(paths[0])]
    assert np.array_equal(np.concatenate(read), np.concatenate(events))
    labels = read_labels(labels_path(paths[0]))
    assert [truth.t_us for truth in labels] == list(range(5_000, recipe.duration_us, 40_000))


def test_a_set_may_hold_both_gels_with_people_of_their_own():
    recipes = dataset.plan_dataset(2, 1.0, 3, ("half-space", "solid"))
    assert len(recipes) == 20
    assert sum(recipe.duration_us for recipe in recipes) == 60_000_000
    assert recipes[10].name == "user1-push-solid"
    first, second = (dataset.simulate_recipe(recipes[k]) for k in (0, 10))
    assert first.truth(0).markers_px[0, 0] != second.truth(0).markers_px[0, 0]
    assert recipes[:10] == dataset.plan_dataset(2, 0.5, 3)  # the half-space half is the plain set


def test_finished_recordings_are_kept_and_others_written_again(small_set):
    folder, paths, _ = small_set
    stamps = [path.stat().st_mtime_ns for path in paths]
    manifest = json.loads((folder / dataset.MANIFEST).read_text())
    del manifest[paths[1].stem]  # as if stopped while it was written
    (folder / dataset.MANIFEST).write_text(json.dumps(manifest))
    labels_path(paths[2]).unlink()
    dataset.write_dataset(folder, users=1, minutes=0.1, seed=2)
    again = [path.stat().st_mtime_ns for path in paths]
    changed = [old != new for old, new in zip(stamps, again, strict=True)]
    assert changed == [False, True, True, False, False]


@pytest.mark.parametrize("ending", [".mkv", ".aedat4"])
def test_a_set_whose_first_recording_was_killed_goes_on_and_keeps_nothing_of_it(tmp_path, ending):
    folder = tmp_path / "new"
    nuisances = {"uvc": 20.0} if ending == ".mkv" else {}

    def write_first(end):
        def progress(now):
            if now.share >= end:
                os._exit(9)

        dataset.write_dataset(folder, 1, 0.11, 2, progress, nuisances=nuisances)

    killed = get_context("fork").Process(target=write_first, args=(0.5,))
    killed.start()
    killed.join()
    assert killed.exitcode == 9
    left = {path.name for path in folder.iterdir()}
    assert any("user1-push" in name for name in left)
    dataset.write_dataset(folder, users=1, minutes=0.11, seed=2, nuisances=nuisances)
    names = [f"user1-{kind.label}" for kind in dataset.KINDS]
    expected = {f"{name}{part}" for name in names for part in (ending, ".labels.csv")}
    assert {path.name for path in folder.iterdir()} == expected | {dataset.MANIFEST}


def test_another_set_is_never_replaced_unasked(small_set):
    folder, paths, _ = small_set
    before = paths[0].read_bytes()
    with pytest.raises(RecordingError, match=r"of another set \(seed 2\)") as caught:
        dataset.write_dataset(folder, users=1, minutes=0.1, seed=9)
    assert "--force" in caught.value.hint
    assert paths[0].read_bytes() == before
    (folder / dataset.MANIFEST).rename(folder / "gone.json")
    with pytest.raises(RecordingError, match="of unknown origin"):
        dataset.write_dataset(folder, users=1, minutes=0.1, seed=2)
    (folder / "gone.json").rename(folder / dataset.MANIFEST)


def test_two_programs_never_write_into_one_folder_at_once(tmp_path):
    refused = []

    def begin_another(_):
        if not refused:
            with pytest.raises(RecordingError, match="Another program writes") as found:
                dataset.write_dataset(tmp_path, users=1, minutes=0.05, seed=2)
            refused.append(found.value.hint)

    made = dataset.write_dataset(tmp_path, users=1, minutes=0.05, seed=1, progress=begin_another)
    assert refused
    assert (
        dataset.write_dataset(tmp_path, users=1, minutes=0.05, seed=1) == made
    )  # the lock has gone


def test_clips_never_take_the_labels_of_recordings_unasked(small_set):
    folder, paths, _ = small_set
    before = labels_path(paths[0]).read_bytes()
    with pytest.raises(RecordingError, match=r"push\.labels\.csv' exists already, of another set"):
        dataset.write_dataset(folder, users=1, minutes=0.1, seed=2, nuisances={"uvc": 20.0})
    assert labels_path(paths[0]).read_bytes() == before
    assert not list(folder.glob("*.mkv"))


def test_a_rig_file_of_a_replaced_recording_goes(tmp_path):
    recipe = dataset.plan_dataset(1, 0.1, 2)[0]
    path = tmp_path / "user1-push.aedat4"
    rig = path.with_suffix(".rig.yaml")
    rig.write_text("strobe: {hz: 20, dark_us: 1000}\n")
    list(dataset._record(recipe, path, "", PAPER_GEL, b"", None))
    assert not rig.exists()


def test_a_folder_that_cannot_be_made_has_a_fix(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(RecordingError, match="cannot be written: Not a directory") as caught:
        dataset.write_dataset(tmp_path / "file" / "set", users=1, minutes=0.1, seed=2)
    assert caught.value.hint.startswith("See what each part of its path is: namei -l ")


def test_a_set_is_distributed_like_the_papers():
    labels, speeds, contacts = Counter(), [], []
    sizes = {kind: [] for kind in dataset.KINDS}
    for recipe in dataset.plan_dataset(2, 2.0, 1):
        kind = GestureKind[recipe.gesture.upper()]
        person, config = meet_person(1000 * recipe.seed + recipe.user)
        rng = np.random.default_rng((recipe.seed, recipe.user, kind))
        script = dataset.draw_script(recipe.name, kind, recipe.duration_us, person, rng)
        rig: Rig = config.camera.rig
        motion = GelMotion(script, CameraModel(config.camera), config.gel)
        truths = [motion.truth(t) for t in range(5_000, recipe.duration_us, 40_000)]
        labels.update(truth.kind for truth in truths)
        sizes[kind] += [truth.intensity_mm for truth in truths if truth.kind]
        speeds.append(np.diff([truth.intensity_mm for truth in truths]) / 0.04)
        contacts += [rig.to_mm(truth.contacts_px) for truth in truths if truth.kind]
    shares = {kind: n / labels.total() for kind, n in labels.items()}
    assert shares[GestureKind.NONE] == pytest.approx(0.4, abs=0.06)
    assert all(0.08 < shares[kind] < 0.16 for kind in dataset.KINDS)
    means = {kind: np.mean(values) for kind, values in sizes.items()}
    assert max(means, key=means.get) == GestureKind.PUSH
    assert max(sizes[GestureKind.ZOOM]) < 10.0
    assert 4.5 < means[GestureKind.PUSH] < 8.0
    assert max(max(values) for values in sizes.values()) < 19.0
    everything = np.concatenate(list(sizes.values()))
    assert 0.6 < (everything < 6.0).mean() < 0.9
    speed = np.concatenate(speeds)
    assert 60 < np.abs(speed).max() < 240
    assert abs(np.median(speed)) < 1.0
    points = np.concatenate(contacts)
    assert np.hypot(*points.T).max() < 28.0
    assert {len(c) for c in contacts} == {1, 2, 3}
