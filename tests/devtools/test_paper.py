"""What ``make paper`` says: each figure and picture that changed, and no other."""

import re
import shutil
import sys

import pytest
from neurotouch_devtools.paper import __main__ as paper
from neurotouch_devtools.paper import (
    compare_pictures,
    compare_results,
    format_results,
    list_results,
    read_results,
)
from neurotouch_devtools.paper.__main__ import RESULTS, find_differences

from neurotouch_hid.evaluation.accuracy import Tally, summarise
from neurotouch_hid.messages import GestureKind
from tests.docs.prose import ROOT
from tests.evaluation.timelines import RIG, answer, label

FIGURES = ROOT / "docs" / "research" / "figures"


@pytest.fixture
def committed():
    results = read_results((FIGURES / RESULTS).read_text())
    return results, {path.stem: path.read_text() for path in FIGURES.glob("*.svg")}


def test_without_figures_to_compare_with_nothing_is_made(monkeypatch, capsys, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["paper"])
    monkeypatch.setattr(paper, "handle_interrupts", lambda: None)
    monkeypatch.setattr(paper, "make_parts", lambda *_, **__: pytest.fail("it began"))
    assert paper.main() == 1
    assert "There is no file 'docs/research/figures/results.csv'" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_what_is_committed_does_not_differ_from_itself(committed):
    assert find_differences(FIGURES, *committed) == []
    assert len(committed[0]) > 200
    assert len(committed[1]) == 12


def test_a_changed_figure_and_a_changed_picture_are_named(tmp_path, committed):
    folder = tmp_path / "figures"
    shutil.copytree(FIGURES, folder)
    table = folder / RESULTS
    row = next(row for row in committed[0] if row[:3] == ("hard", "neurotouch", "gesture_accuracy"))
    line = format_results([row]).splitlines()[1]
    before = format_results([row._replace(value=row.value - 0.02)]).splitlines()[1]
    assert table.read_text().count(line) == 1
    table.write_text(table.read_text().replace(line, before))
    picture = folder / "table-summary.svg"
    moved = re.sub(r"(M \d+\.\d+ )(\d)", r"\g<1>9\2", picture.read_text(), count=1)
    assert moved != picture.read_text()
    picture.write_text(moved)
    figure, drawn = find_differences(folder, *committed)
    assert figure.startswith("hard neurotouch gesture_accuracy: ")
    assert f"became {100 * row.value:.2f} %" in figure
    assert drawn.startswith("Picture table-summary: something moved by ")


def test_what_a_few_slices_change_is_no_difference(committed):
    results, pictures = committed
    near = [
        row if row.value is None or row.unit != "%" else row._replace(value=row.value + 0.004)
        for row in results
    ]
    assert compare_results(results, near) == []
    far = [row._replace(value=(row.value or 0.0) + 1.0) for row in results if row.unit == "mm"]
    assert len(compare_results([row for row in results if row.unit == "mm"], far)) == len(far)
    named = {
        name: re.sub(r'id="p[0-9a-f]{10}"', 'id="p0123456789"', svg)
        for name, svg in pictures.items()
    }
    assert compare_pictures(pictures, named) == []


def test_what_is_missing_new_or_undefined_is_named(committed):
    results, pictures = committed
    lacking = compare_results(results, results[1:])
    assert len(lacking) == 1
    assert lacking[0].endswith("is no longer made.")
    assert compare_results(results[1:], results)[0].endswith("is new.")
    undefined = [results[0], results[1]._replace(value=None), *results[2:]]
    assert compare_results(results, undefined)[0].endswith("became undefined.")
    name = next(iter(pictures))
    assert compare_pictures(pictures, {}).count(f"Picture {name} is no longer made.") == 1
    words = {name: pictures[name].replace("<!-- ", "<!-- other ", 1)}
    assert compare_pictures({name: pictures[name]}, words) == [
        f"Picture {name} is drawn otherwise."
    ]


def test_all_figures_of_a_report_are_in_the_table():
    tally = Tally(frames=9)
    for k in range(60):
        truth = label(10_000 * k, GestureKind.PUSH if k % 2 else GestureKind.NONE, 3.0 * (k % 2))
        tally.add_gesture(answer(truth), truth, RIG)
    report = summarise(tally)
    results = list(list_results("set", "mine", report, whole=True))
    assert read_results(format_results(results)) == results
    by_key = {row.figure: row for row in results}
    assert by_key["gesture_accuracy"].value == 1.0
    assert by_key["gesture_accuracy"].of == 60
    assert by_key["per_gesture.push.recall"].of == 30
    assert by_key["by_intensity.3.0.gesture_accuracy"].of == 30
    assert by_key["distance_mm"].unit == "mm"
    assert len(list(list_results("set", "mine", report, whole=False))) < 20
