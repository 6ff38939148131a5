"""Which changes are made of a source, and that a module with good tests lets none of them live."""

import ast
from pathlib import Path

import pytest

from tests.mutants.__main__ import MODULES
from tests.mutants.operators import find_mutants

ROOT = Path(__file__).parents[2]
SOURCE = b"""LIMIT = 5

class Box:
    def read(self, size: int | None = 3) -> bool:
        while size < LIMIT and not self.full:
            size += 2
            if self.ended:
                break
        self.n = size - 1
        return size in self.known
"""


def test_every_operator_changes_one_place():
    found = find_mutants("box.py", SOURCE)
    assert {mutant.function for mutant in found} == {"Box.read"}
    assert {(mutant.line, mutant.operator, mutant.text) for mutant in found} == {
        (5, "compare", "<="),
        (5, "and/or", "or"),
        (5, "not", "(self.full)"),
        (6, "delete", "pass"),
        (6, "constant", "(2 + 1)"),
        (6, "constant", "(2 - 1)"),
        (7, "branches", "not (self.ended)"),
        (8, "break", "continue"),
        (9, "delete", "pass"),
        (9, "+/-", "+"),
        (9, "constant", "(1 + 1)"),
        (9, "constant", "(1 - 1)"),
        (10, "return", "True"),
        (10, "return", "False"),
        (10, "compare", "not in"),
    }


def test_a_mutant_shows_its_line_before_and_after():
    mutant = next(m for m in find_mutants("box.py", SOURCE) if m.operator == "+/-")
    assert mutant.diff(SOURCE) == ("self.n = size - 1", "self.n = size + 1")


@pytest.mark.parametrize("path", MODULES)
def test_all_mutants_of_the_table_are_python_and_their_tests_exist(path):
    source = (ROOT / path).read_bytes()
    found = find_mutants(path, source)
    assert found
    for mutant in found:
        changed = mutant.apply(source)
        assert changed != source
        ast.parse(changed)
    assert all((ROOT / test).is_file() for test in MODULES[path])
