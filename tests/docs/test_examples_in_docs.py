"""Every profile in the documents is one."""

import re

import pytest

from neurotouch_hid.profile import check_content
from tests.docs.prose import ROOT

PAGE = ROOT / "docs" / "profiles.md"
EXAMPLES = re.findall(r"```yaml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.parametrize("text", EXAMPLES)
def test_an_example_has_no_mistake(text):
    checked = check_content(text.encode(), "example.yaml")
    assert checked.whole is not None, checked.format()
    assert checked.format() == ""


def test_there_are_examples_and_a_wrong_one_is_found():
    assert len(EXAMPLES) >= 3
    wrong = EXAMPLES[0].replace("button: a", "buttons: a")
    assert check_content(wrong.encode(), "example.yaml").whole is None
