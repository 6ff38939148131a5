"""What Hypothesis draws: the same in every run, or a test would fail in some of them only."""

import importlib

from hypothesis import given, settings
from hypothesis import strategies as st


def draw() -> list[int]:
    drawn = []

    @settings(max_examples=1000)
    @given(st.integers())
    def look(number):
        drawn.append(number)

    look()
    return drawn


def test_examples_do_not_depend_on_which_modules_are_loaded(tmp_path, monkeypatch):
    before = draw()
    (tmp_path / "full_of_numbers.py").write_text(f"NUMBERS = {[*range(70_000, 70_400)]}\n")
    monkeypatch.syspath_prepend(tmp_path)
    importlib.import_module("full_of_numbers")
    assert draw() == before
