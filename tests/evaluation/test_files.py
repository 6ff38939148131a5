"""Whole recordings: simulated, written, played through the line and compared with their labels."""

import json
from concurrent.futures import Future
from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from neurotouch_hid.cli.evaluate import command
from neurotouch_hid.driver import REFERENCE, kernel_loading
from neurotouch_hid.errors import GelNotFoundError, NeuroTouchError, RecordingError
from neurotouch_hid.evaluation.accuracy import evaluate_files, files, format_table
from neurotouch_hid.evaluation.accuracy.files import _read_labels, evaluate_file
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame
from neurotouch_hid.recording import RecordingWriter, labels_path, write_labels
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.script import sequence
from neurotouch_hid.source.simulator.strokes import StrokeTiming, push, twist

TIMING = StrokeTiming(200_000, 200_000, 200_000)
PAPER = replace(REFERENCE, method="paper")


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recordings")
    strokes = {"push": push(0.5, 7.0, timing=TIMING), "twist": twist(0.5, timing=TIMING)}
    paths = []
    for name, stroke in strokes.items():
        script = sequence(name, stroke, rest_us=300_000, gap_us=200_000)
        truths = []
        path = folder / f"{name}.aedat4"
        with Simulator(script, seed=4) as simulator, RecordingWriter(path) as writer:
            for packet in simulator:
                writer.write(packet)
                truths += [simulator.truth(frame.t_us) for frame in packet.frames]
        write_labels(labels_path(path), truths)
        paths.append(path)
    return paths


def test_simulated_recordings_are_recognised(recordings):
    done = []
    report = evaluate_files(recordings, PAPER, progress=done.append).report()
    assert done == recordings
    assert list(report["files"]) == ["push", "twist"]
    for figures in (report, *report["files"].values()):
        assert figures["gesture_accuracy"] > 0.75
        assert figures["distance_mm"] < 8.0
        assert figures["rest_f1"] > 0.7
        assert figures["frames"] > 20
        assert figures["events"] > 10_000
        assert figures["realtime_factor"] > 0.0
    for key in ("frames", "events", "observations"):
        assert report[key] == sum(figures[key] for figures in report["files"].values())
    assert report["files"]["push"]["per_gesture"]["push"]["recall"] > 0.8
    json.dumps(report, allow_nan=False)
    assert "resting position F1" in format_table(report)


def test_two_processes_give_the_same_figures(recordings):
    def figures(jobs):
        report = evaluate_files(recordings, PAPER, jobs=jobs).report()
        for part in (report, *report["files"].values()):
            del part["realtime_factor"]
        return report

    assert figures(2) == figures(1)


def test_the_largest_recording_is_begun_first_and_the_order_of_the_results_stays(
    recordings, monkeypatch
):
    begun = []

    class Pool:
        def submit(self, function, *args):
            if function is evaluate_file:
                begun.append(args[0])
            done = Future()
            done.set_result(function(*args))
            return done

    monkeypatch.setattr(files, "open_pool", lambda *_: nullcontext(Pool()))
    ordered = sorted(recordings, key=lambda path: path.stat().st_size)
    assert list(evaluate_files(ordered, PAPER, jobs=2).files) == [path.stem for path in ordered]
    assert begun == ordered[::-1]


def test_files_of_one_name_keep_their_folders(recordings, tmp_path):
    copy = tmp_path / "push.aedat4"
    copy.write_bytes(recordings[0].read_bytes())
    labels_path(copy).write_bytes(labels_path(recordings[0]).read_bytes())
    names = evaluate_files([recordings[0], copy], PAPER).files
    assert set(names) == {str(recordings[0]), str(copy)}


def test_missing_labels_are_told_before_anything_is_played(recordings, tmp_path):
    bare = tmp_path / "bare.aedat4"
    bare.write_bytes(recordings[0].read_bytes())
    done = []
    with pytest.raises(RecordingError, match=r"bare\.labels\.csv"):
        evaluate_files([recordings[0], bare], PAPER, progress=done.append)
    assert not done


def test_that_the_first_time_compiles_is_said_only_while_it_takes_long(recordings, monkeypatch):
    told = []
    monkeypatch.setattr(kernel_loading, "_PATIENCE_S", 0.0)
    monkeypatch.setattr(kernel_loading, "_loaded", set())
    evaluate_files(recordings[:1], PAPER, announce=told.append)
    assert [sentence[:33] for sentence in told] == ["Loading (the first time compiles "]
    told.clear()
    monkeypatch.setattr(kernel_loading, "_PATIENCE_S", 60.0)
    evaluate_files(recordings[:1], PAPER, announce=told.append)
    assert not told


def test_a_recording_without_a_gel_is_refused(recordings, tmp_path):
    path = tmp_path / "dark.aedat4"
    events = np.array([(t, 5, 5, True) for t in range(0, 400_000, 1_000)], EVENT_DTYPE)
    dark = np.zeros((260, 346), np.uint8)
    frames = tuple(Frame(dark, t, t + 5_000) for t in range(0, 390_000, 40_000))
    with RecordingWriter(path) as writer:
        writer.write(EventPacket(0, 400_000, events, frames))
    labels_path(path).write_bytes(labels_path(recordings[0]).read_bytes())
    with pytest.raises(GelNotFoundError, match=r"No gel was found in '.*dark\.aedat4': "):
        evaluate_files([path], PAPER)
    made = "version: 1\nname: mine\nlayout: {kind: hex, pitch_mm: 4.0, radius_mm: 24}\n"
    path.with_suffix(".gel.yaml").write_text(made)
    with pytest.raises(GelNotFoundError, match=r"No gel 'mine' of 127 dots was found in '") as told:
        evaluate_files([path], PAPER)
    source = "It comes from --gel, NAME.gel.yaml beside a recording, or gel.yaml."
    assert (told.value.hint or "").endswith(f"Is 'mine' another gel? {source}")


def test_a_rig_file_that_says_the_wrong_place_is_named(recordings, tmp_path):
    path = tmp_path / "push.aedat4"
    path.write_bytes(recordings[0].read_bytes())
    labels_path(path).write_bytes(labels_path(recordings[0]).read_bytes())
    path.with_suffix(".rig.yaml").write_text("centre_px: [60, 60]\npx_per_mm: 2.5\n")
    with pytest.raises(GelNotFoundError, match="at the place that its rig says") as caught:
        evaluate_files([path], PAPER)
    assert "NAME.rig.yaml" in caught.value.hint


def test_labels_in_another_time_are_refused(recordings, tmp_path):
    path = tmp_path / "push.aedat4"
    path.write_bytes(recordings[0].read_bytes())
    truths = [replace(truth, t_us=truth.t_us + 10**15) for truth in _read_labels(recordings[0])]
    write_labels(labels_path(path), truths)
    with pytest.raises(RecordingError, match=r"push\.labels\.csv' labels no moment of") as caught:
        evaluate_files([recordings[1], path], PAPER)
    assert f"from {truths[0].t_us} to {truths[-1].t_us} µs, the recording is from" in str(
        caught.value
    )
    assert "timestamp_us in µs" in caught.value.hint


@pytest.mark.parametrize("jobs", [1, 2])
def test_an_error_of_a_recording_comes_through(recordings, tmp_path, jobs):
    broken = tmp_path / "broken.aedat4"
    broken.write_bytes(b"not a recording")
    labels_path(broken).write_bytes(labels_path(recordings[0]).read_bytes())
    with pytest.raises((RecordingError, GelNotFoundError)) as caught:
        evaluate_files([broken, recordings[0]], PAPER, jobs=jobs)
    assert "broken" in caught.value.message


def test_methods_side_by_side(recordings, tmp_path):
    numbers, report = tmp_path / "out.json", tmp_path / "report"
    methods = ["--method", "paper", "--method", "neurotouch", "--method", "paper"]
    result = CliRunner().invoke(
        command,
        [
            str(recordings[0]),
            str(recordings[0]),
            *methods,
            "--json",
            str(numbers),
            "--report",
            str(report),
        ],
        catch_exceptions=False,
    )
    assert result.exit_code == 0
    figures = json.loads(numbers.read_text(encoding="utf-8"))
    assert list(figures["methods"]) == ["paper", "neurotouch"]
    whole = {key: figures[key] for key in ("methods", "origin")}
    assert {**figures["methods"]["paper"], **whole} == figures
    assert figures["origin"]["recordings"] == 1
    assert "2 of 2" in result.stderr
    assert result.stdout.count("gesture type accuracy") == 2
    assert json.loads((report / "report.json").read_text(encoding="utf-8")) == figures


def test_a_folder_that_cannot_take_the_report_is_told_before_anything_is_played(
    recordings, tmp_path
):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(NeuroTouchError, match="not part of a report"):
        CliRunner().invoke(
            command, [str(recordings[0]), "--report", str(tmp_path)], catch_exceptions=False
        )


def test_the_length_of_a_slice_changes_no_figure_much(recordings):
    reports = [
        evaluate_files(recordings, replace(REFERENCE, rate_hz=rate_hz)).report()
        for rate_hz in (100, 250, 1000)
    ]
    for report in reports[1:]:
        assert report["observations"] > 2 * reports[0]["observations"]
        for key, tolerance in (
            ("gesture_accuracy", 0.03),
            ("count_accuracy", 0.05),
            ("intensity_mae_mm", 0.1),
        ):
            assert report[key] == pytest.approx(reports[0][key], abs=tolerance), key
