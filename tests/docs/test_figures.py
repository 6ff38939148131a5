"""The tables of the documents print what ``make paper`` makes, rounded."""

import re

import pytest
from neurotouch_devtools.dataset import EDITION, SPLITS, list_parts
from neurotouch_devtools.paper import read_results

from tests.docs.prose import ROOT

RESEARCH = ROOT / "docs" / "research"
VALUES = {row[:3]: row for row in read_results((RESEARCH / "figures" / "results.csv").read_text())}
KEYS = {
    "gesture type": "gesture_accuracy",
    "right type of gesture": "gesture_accuracy",
    "type": "gesture_accuracy",
    "gesture type from 2.5 mm on": "gesture_accuracy_from_2.5_mm",
    "gesture type from 2.5 mm": "gesture_accuracy_from_2.5_mm",
    "type from 2.5 mm": "gesture_accuracy_from_2.5_mm",
    "contact count": "count_accuracy",
    "right number of fingers": "count_accuracy",
    "contact distance": "distance_mm",
    "error of the finger's place": "distance_mm",
    "intensity error": "intensity_mae_mm",
    "intensity MAE": "intensity_mae_mm",
    "gestures that change type": "type_changes",
    "gestures that change type afterwards": "type_changes",
    "resting position F1": "rest_f1",
    "rest F1": "rest_f1",
}
"""What the documents call a figure."""


def read_table(page, head):
    """The cells of the rows below a head that begins like this, and of the head itself."""
    lines = (ROOT / page).read_text().splitlines()
    (start,) = (i for i, line in enumerate(lines) if line.startswith(head))
    rows = []
    for line in [lines[start], *lines[start + 2 :]]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip(" `") for cell in line.strip("|").split("|")])
    return rows


def find_fault(cell, data, method, figure):
    """What is wrong with a printed figure; None if it is the made one, rounded."""
    row = VALUES[data, method, figure]
    printed = re.match(r"(\d+)(?:\.(\d+))?", cell)
    times = 100.0 if "%" in cell or (row.unit == "%" and float(printed[0]) > 1.0) else 1.0
    half = 0.5 * 10.0 ** -len(printed[2] or "") + 1e-9
    if abs(float(printed[0]) - times * row.value) <= half:
        return None
    return f"{data} {method} {figure}: '{cell}' is printed, {times * row.value:.4f} was made"


@pytest.mark.parametrize(
    ("page", "head", "column", "method"),
    [
        ("docs/research/results.md", "| | the paper, real hands |", 2, "paper"),
        ("docs/research/results.md", "| | the paper, real hands |", 3, "neurotouch"),
        ("docs/research/notebook-recognition.md", "| | goal | `neurotouch`", 2, "neurotouch"),
        ("docs/research/notebook-recognition.md", "| | goal | `neurotouch`", 3, "paper"),
        ("README.md", "| measure | the paper, real hands", 2, "neurotouch"),
    ],
)
def test_columns_of_the_hard_set(page, head, column, method):
    rows = read_table(page, head)[1:]
    faults = [find_fault(row[column], "hard", method, KEYS[row[0]]) for row in rows]
    assert [fault for fault in faults if fault] == []
    assert len(rows) >= 3


def test_our_rows_of_the_benchmark():
    head, *rows = read_table("docs/research/benchmark.md", "| method | by |")
    ours = [row for row in rows if row[1] == "us"]
    assert {row[0] for row in ours} == {"paper", "neurotouch"}
    faults = [
        find_fault(cell, "judge", row[0], KEYS[name])
        for row in ours
        for name, cell in zip(head[3:], row[3:], strict=True)
    ]
    assert [fault for fault in faults if fault] == []


def test_the_benchmark_by_folder():
    _, *rows = read_table("docs/research/benchmark.md", "| folder |")
    faults = [
        find_fault(cell, f"judge/{folder}", method, "gesture_accuracy")
        for folder, *cells in rows
        for method, cell in zip(("paper", "neurotouch"), cells, strict=True)
    ]
    assert [fault for fault in faults if fault] == []
    assert [f"judge/{row[0]}" for row in rows] == [part.folder for part in list_parts("judge")]


def test_the_data_card_has_each_folder_with_its_seeds():
    _, *rows = read_table("docs/research/dataset.md", "| folder |")
    for split, column in zip(SPLITS, (4, 5), strict=True):
        seeds = {f"{split}/{row[0]}": int(row[column]) for row in rows}
        assert seeds == {part.folder: part.seed for part in list_parts(split)}
    assert f"## Edition {EDITION}\n" in (RESEARCH / "dataset.md").read_text()


def test_a_wrong_figure_is_found():
    row = VALUES["hard", "neurotouch", "gesture_accuracy"]
    right = f"{100 * row.value:.1f} %"
    assert find_fault(right, *row[:3]) is None
    assert find_fault(f"{100 * row.value + 0.2:.1f} %", *row[:3])
