"""Every path that the page names is there."""

import re

import pytest

from tests.docs.prose import ROOT

PAGE = ROOT / "docs" / "develop" / "where.md"
ROWS = [
    line for line in PAGE.read_text(encoding="utf-8").splitlines() if "?" in line and "`" in line
]


def test_there_are_twenty_questions():
    assert len([row for row in ROWS if row.startswith("| ")]) >= 20


@pytest.mark.parametrize("row", ROWS)
def test_the_path_is_there(row):
    answer = row.split("?", 1)[1]
    for path in re.findall(r"`([^`]+)`", answer):
        assert (ROOT / "neurotouch_hid" / path).exists() or (ROOT / path).exists(), path
