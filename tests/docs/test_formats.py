"""The tables of keys in the documents are those of the program."""

import importlib.util
import re
from typing import Any

import pytest

from neurotouch_hid.evaluation.accuracy import Tally, combine_reports, summarise, trace_origin
from neurotouch_hid.messages import GestureKind
from tests.docs.prose import ROOT

_SPEC = importlib.util.spec_from_file_location(
    "profile_reference", ROOT / "docs" / "extensions" / "profile_reference.py"
)
assert _SPEC is not None
assert _SPEC.loader is not None
reference = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(reference)


@pytest.mark.parametrize("page", reference.SCHEMAS)
def test_tables_are_current(page: str):
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    assert reference.renew(page, text) == text, "run: python docs/extensions/profile_reference.py"


def test_a_missing_key_is_found():
    text = (ROOT / "docs" / "profile-format.md").read_text(encoding="utf-8")
    (row,) = [line for line in text.splitlines() if line.startswith("| `extends` |")]
    assert reference.renew("profile-format.md", text.replace(row + "\n", "")) == text


def test_what_is_escaped_and_what_is_not():
    words = "a_b, ``c_d`` | [e]"
    table = reference.render_schema({"properties": {"key": {"description": words}}})
    assert "| `key` | any value | a\\_b, `c_d` \\| \\[e] |" in table


def test_the_report_of_an_evaluation_is_documented():
    text = (ROOT / "docs" / "research" / "formats.md").read_text(encoding="utf-8")
    table = text[text.index("## Report:") :]
    documented = set(re.findall(r"`([a-z0-9_.]+)`", table))
    kinds = {kind.label for kind in GestureKind}
    keys = _list_keys(combine_reports({"a": summarise(Tally()), "b": {}}, trace_origin([])))
    assert keys - kinds <= documented | {"a", "b"}
    assert documented - keys <= {"files", "none", "null"}


def _list_keys(value: Any) -> set[str]:
    if not isinstance(value, dict):
        return set()
    return set(value).union(*(_list_keys(inner) for inner in value.values()))
