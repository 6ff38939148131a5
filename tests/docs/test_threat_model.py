"""Each sentence of the threat model names a test, and the test is there."""

import ast
import re

import pytest

from tests.docs.prose import ROOT

PAGE = ROOT / "docs" / "develop" / "threat-model.md"
HOLDS = PAGE.read_text(encoding="utf-8").split("## What holds it")[1].split("\n## ")[0]
ROWS = [
    row
    for row in HOLDS.splitlines()
    if row.startswith("| ") and row not in ("| sentence | test |", "| --- | --- |")
]


def test_there_are_many_sentences():
    assert len(ROWS) > 30


@pytest.mark.parametrize("row", ROWS)
def test_the_test_of_a_sentence_is_there(row):
    sentence, test = (part.strip() for part in row.strip("|").split("|"))
    assert sentence.endswith(".")
    path, name = re.fullmatch(r"`(tests/[\w/]+\.py)::(test_\w+)`", test).groups()
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    assert name in [node.name for node in tree.body if isinstance(node, ast.FunctionDef)]


def test_the_report_of_a_problem_leads_here():
    assert "docs/develop/threat-model.md" in (ROOT / "SECURITY.md").read_text(encoding="utf-8")
