"""The report: a page that stands alone, figures as files, the numbers of the JSON file."""

import base64
import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.evaluation.accuracy import (
    Evaluation,
    LabelTrack,
    Origin,
    Tally,
    combine_reports,
    trace_origin,
)
from neurotouch_hid.evaluation.accuracy.files import Played
from neurotouch_hid.evaluation.accuracy.label_statistics import LabelStatistics
from neurotouch_hid.evaluation.accuracy.moments import WorstMoments
from neurotouch_hid.evaluation.accuracy.report import check_folder, write, write_report
from neurotouch_hid.evaluation.accuracy.type_timing import Stopwatch
from neurotouch_hid.messages import EVENT_DTYPE, GestureKind
from neurotouch_hid.recording import RecordingWriter, Simulation
from tests.evaluation.timelines import RIG, answer, label, markers

ORIGIN = Origin("neurotouch-hid 1.2.3", "neurotouch evaluate a b", "2026-01-02", 2, 2, (5,))
RESULTS = [
    "confidence-reliability",
    "confusion-matrix",
    "errors-gestures",
    "intensity-accuracy",
    "labels-boxes",
    "labels-contacts",
    "labels-intensities",
    "labels-speeds",
    "labels-types",
    "table-summary",
    "timing-types",
    "types-metrics",
]


def make_labels():
    """A rest and a gesture of each type."""
    truths, t_us = [], 0
    for kind in list(GestureKind)[1:]:
        for intensity in (0, 0, 0, 1, 3, 5, 7, 5, 3, 1):
            t_us += 40_000
            truths.append(label(t_us, kind if intensity else GestureKind.NONE, intensity))
    return truths


def play(error_mm, wrong):
    """A recording in which every third gesture slice is recognised as ``wrong``."""
    truths = make_labels()
    stopwatch, worst = Stopwatch(LabelTrack(truths)), WorstMoments()
    tally = Tally(timing=stopwatch.timing, frames=9, events=1234567, sensor_s=2.0, host_s=1.0)
    for k, truth in enumerate(truths):
        is_wrong = k % 3 == 0 and truth.kind is not GestureKind.NONE
        gesture = answer(
            truth,
            kind=wrong if is_wrong else None,
            intensity=truth.intensity_mm + error_mm,
            contacts=truth.contacts_px + 2.0 * truth.kind,
            confidence=0.4 + 0.013 * (k % 37),
        )
        tally.add_gesture(gesture, truth, RIG)
        tally.add_rest(labelled=truth.kind is GestureKind.NONE, detected=k % 5 > 0)
        stopwatch.add(truth.t_us, 40_000, truth, gesture.kind)
        worst.add(truth.t_us / 1e6, markers(truth.t_us, (3.0, 2.0)), gesture, truth, RIG)
    return Played(tally, worst.ranked(), LabelStatistics.of(truths, RIG))


def evaluate(error_mm, wrong):
    return Evaluation(
        {"first": play(error_mm, wrong), "<b>&second": play(2 * error_mm, GestureKind.NONE)}
    )


class Page(HTMLParser):
    """Reads a page: that its tags are closed in order, its images, numbers, words and places."""

    VOID = frozenset({"meta", "img", "br", "link", "input"})

    def __init__(self, text):
        super().__init__()
        self.open, self.images, self.numbers, self.ids, self.links = [], {}, [], set(), set()
        self.headings, self.words = [], []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        assert tag not in {"script", "link", "iframe", "object"}
        if tag not in self.VOID:
            self.open.append(tag)
        if tag == "img":
            self.images[attributes["id"]] = attributes
        if tag == "data":
            self.numbers.append(float(attributes["value"]))
        if re.fullmatch("h[1-6]", tag):
            self.headings.append(int(tag[1]))
        if "id" in attributes:
            assert attributes["id"] not in self.ids
            self.ids.add(attributes["id"])
        if attributes.get("href"):
            self.links.add(attributes["href"])

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)


@pytest.fixture(scope="module")
def evaluations():
    return {"paper": evaluate(0.5, GestureKind.PUSH), "other": evaluate(0.25, GestureKind.ZOOM)}


@pytest.fixture(scope="module")
def folder(evaluations, tmp_path_factory):
    folder = tmp_path_factory.mktemp("out") / "deep" / "report"
    said = []
    write_report(folder, evaluations, ORIGIN, said.append)
    assert said
    return folder


def test_page_and_numbers_say_where_they_come_from(folder):
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert "SIMULATED: 2 recordings of the simulator, seed 5." in text
    assert "neurotouch-hid 1.2.3" in text
    assert "neurotouch evaluate a b" in text
    assert json.loads((folder / "report.json").read_text())["origin"] == {
        **ORIGIN.as_json(),
        "seeds": [5],
        "simulated_by": [],
    }


def test_a_name_that_is_no_utf8_loses_no_report(evaluations, tmp_path, monkeypatch):
    monkeypatch.setattr(write, "draw_pictures", lambda *_: [])
    origin = replace(ORIGIN, command="neurotouch evaluate play\udce9.aedat4")
    write_report(tmp_path / "report", evaluations, origin)
    assert "evaluate play?.aedat4" in (tmp_path / "report/report.html").read_text(encoding="utf-8")


def test_what_is_simulated_is_known_from_the_set(tmp_path):
    (tmp_path / "dataset.json").write_text('{"a": {"seed": 7}, "b": {"seed": 3}}')
    paths = [record(tmp_path / f"{name}.aedat4") for name in ("a", "b", "real")]
    assert str(trace_origin(paths)) == "SIMULATED in part: 2 of 3 recordings, seed 3, 7."
    assert "none of them marked as simulated" in str(trace_origin(paths[2:]))


def record(path, simulation=None):
    with RecordingWriter(path, simulation=simulation) as writer:
        writer.write_events(np.zeros(1, EVENT_DTYPE))
    return path


def test_what_is_simulated_is_known_from_each_recording(tmp_path):
    mark = Simulation("neurotouch-hid 1.2.3", "sim:tour", "neurotouch record a.aedat4", 9)
    paths = [record(tmp_path / "a.aedat4", mark), record(tmp_path / "real.aedat4")]
    origin = trace_origin(paths)
    assert str(origin) == (
        "SIMULATED in part: 1 of 2 recordings, seed 9, by neurotouch-hid 1.2.3: "
        "neurotouch record a.aedat4."
    )
    assert origin.as_json()["simulated_by"] == ("neurotouch-hid 1.2.3: neurotouch record a.aedat4",)
    unknown = record(tmp_path / "b.aedat4", Simulation("x 1", "sim:mouse"))
    assert str(trace_origin([unknown])) == "SIMULATED: 1 recording of the simulator, seed unknown."


@pytest.fixture(scope="module")
def page(folder):
    return Page((folder / "report.html").read_text(encoding="utf-8"))


def test_every_figure_is_a_file_that_parses(folder):
    names = sorted(path.stem for path in (folder / "figures").iterdir())
    assert [name for name in names if not name.startswith("failures-")] == RESULTS
    gallery = [f"failures-{m}-{k:02d}" for m in ("other", "paper") for k in range(1, 11)]
    assert [name for name in names if name.startswith("failures-")] == gallery
    for path in (folder / "figures").iterdir():
        root = ET.fromstring(path.read_text(encoding="utf-8"))
        assert root.tag == "{http://www.w3.org/2000/svg}svg"
        assert "prefers-color-scheme:dark" in path.read_text(encoding="utf-8")


def test_nothing_else_is_in_the_folder_and_none_beside_it(folder):
    assert sorted(entry.name for entry in folder.iterdir()) == [
        "figures",
        "report.html",
        "report.json",
    ]
    assert [entry.name for entry in folder.parent.iterdir()] == ["report"]


def test_the_page_needs_nothing_but_itself(folder, page):
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert not re.search(r"https?://|url\(|@import", text)
    assert all(link.startswith("#") and link[1:] in page.ids for link in page.links)
    for path in (folder / "figures").iterdir():
        shown = page.images[path.stem]["src"].removeprefix("data:image/svg+xml;base64,")
        assert base64.b64decode(shown) == path.read_bytes()
        bare = re.sub(r'xmlns(:\w+)?="[^"]*"', "", path.read_text(encoding="utf-8"))
        assert not re.search(r"https?://", bare)


def test_the_page_is_accessible(page):
    assert len(page.images) == len(RESULTS) + 20
    assert all(len(image["alt"]) > 30 for image in page.images.values())
    assert page.headings[0] == 1
    assert page.headings.count(1) == 1
    assert all(b - a <= 1 for a, b in zip(page.headings, page.headings[1:], strict=False))


def numbers_of(part):
    """All numbers in a piece of JSON."""
    if isinstance(part, dict):
        return [number for value in part.values() for number in numbers_of(value)]
    if isinstance(part, list):
        return [number for value in part for number in numbers_of(value)]
    return [part] if isinstance(part, int | float) else []


def test_numbers_are_those_of_the_json(folder, page, evaluations):
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    expected = combine_reports({name: each.report() for name, each in evaluations.items()}, ORIGIN)
    assert report == json.loads(json.dumps(expected))
    assert "; methods <strong>" in (folder / "report.html").read_text(encoding="utf-8")
    published = {0.9112, 0.8322, 3.41, 0.96, 0.9403}
    assert set(page.numbers) <= set(map(float, numbers_of(report))) | published
    assert published <= set(page.numbers)
    for method in report["methods"].values():
        for part in ("per_gesture", "by_gesture", "confusion", "time_to_type_ms"):
            assert set(map(float, numbers_of(method[part]))) <= set(page.numbers)
        for part, keys in (
            ("by_intensity", ("gesture_accuracy", "count_accuracy", "observations")),
            ("reliability", ("confidence", "accuracy", "observations", "error")),
        ):
            for key in keys:
                assert set(map(float, numbers_of(method[part][key]))) <= set(page.numbers)
        assert method["gesture_accuracy"] in page.numbers


def test_the_gallery_shows_the_worst_moment_first(page, evaluations):
    played = evaluations["paper"].files
    name, moment = max(
        ((name, moment) for name in played for moment in played[name].worst),
        key=lambda pair: pair[1].severity_mm,
    )
    words = "".join(page.words)
    first = words[words.index("Method paper") :].removeprefix("Method paper").lstrip()
    caption = f"{name}, {moment.since_s:.2f} s (stamp {moment.gesture.t_us} µs)."
    assert first.startswith(caption)
    assert f"Expected: {moment.truth.kind.label.replace('_', ' ')}" in first[:200]


def test_one_method_alone_and_what_is_undefined(tmp_path):
    """Nothing was labelled but rest, and the gel was never found."""
    truths = [label(40_000 * k, GestureKind.NONE) for k in range(5)]
    bare = Played(Tally(), [], LabelStatistics.of(truths, None))
    evaluation = Evaluation({"rest": bare})
    write_report(tmp_path / "report", {"paper": evaluation}, ORIGIN)
    page = Page((tmp_path / "report" / "report.html").read_text(encoding="utf-8"))
    assert sorted(page.images) == RESULTS
    report = json.loads((tmp_path / "report" / "report.json").read_text(encoding="utf-8"))
    assert "methods" not in report
    assert report == json.loads(json.dumps({**evaluation.report(), "origin": ORIGIN.as_json()}))


def test_the_same_report_again_is_the_same_and_replaces_the_old(folder, evaluations):
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    (folder / "figures" / "failures-old-01.svg").write_text("<svg/>")
    write_report(folder, evaluations, ORIGIN)
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before
    assert [entry.name for entry in folder.parent.iterdir()] == ["report"]


@pytest.mark.parametrize("stranger", ["notes.txt", "figures/mine.png"])
def test_a_folder_with_anything_else_is_left_alone(tmp_path, stranger):
    for name in ("report.html", stranger):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("mine")
    with pytest.raises(NeuroTouchError, match="not part of a report") as caught:
        check_folder(tmp_path)
    assert "new folder" in caught.value.hint
    assert (tmp_path / stranger).read_text() == "mine"


def test_an_empty_folder_is_taken_and_a_file_in_the_way_is_told(tmp_path):
    check_folder(tmp_path)
    (tmp_path / "file").write_text("mine")
    with pytest.raises(NeuroTouchError, match="cannot be written"):
        check_folder(tmp_path / "file" / "report")


def test_an_error_leaves_no_trace_and_the_old_report(tmp_path, evaluations):
    def stop(_):
        raise KeyboardInterrupt

    (tmp_path / "report").mkdir()
    (tmp_path / "report" / "report.html").write_text("old")
    with pytest.raises(KeyboardInterrupt):
        write_report(tmp_path / "report", evaluations, ORIGIN, stop)
    assert [path.name for path in tmp_path.iterdir()] == ["report"]
    assert (tmp_path / "report" / "report.html").read_text() == "old"


def test_figures_leave_the_style_of_others_alone(folder):
    import matplotlib as mpl

    assert mpl.rcParams["font.size"] != 11
    assert np.isclose(mpl.rcParams["axes.titlepad"], 6.0)
