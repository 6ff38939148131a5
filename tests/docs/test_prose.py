"""The documents are for people: short sentences, short paragraphs, a named reader."""

from pathlib import Path

import pytest

from tests.docs.prose import ROOT, count_words, find_faults, pages, read_paragraphs

GOOD = "# Title\n\n*For players. After reading you can play.*\n\nShort. It is `a b` good.\n"
LONG = " ".join(["word"] * 31)
MIDDLE = " ".join(["word"] * 15) + "\n" + " ".join(["word"] * 15)


@pytest.mark.parametrize("page", pages(), ids=lambda page: str(page.relative_to(ROOT)))
def test_document_is_readable(page: Path):
    text = page.read_text()
    assert find_faults(text, is_readme=page.name == "README.md") == []


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        pytest.param(GOOD.replace("For players", "Players"), "no line 'For", id="no reader"),
        pytest.param("# Title\n\nFor players.\n", "no line 'For", id="no purpose"),
        pytest.param(GOOD + f"\n{LONG}.\n", "a sentence of 31 words", id="long sentence"),
        pytest.param(GOOD + f"\n- {LONG}.\n", "a sentence of 31 words", id="in a list"),
        pytest.param(
            GOOD + f"\n```{{warning}}\n{LONG}.\n```\n", "a sentence of 31 words", id="in a warning"
        ),
        pytest.param(GOOD + f"\n{MIDDLE}.\n" * 6, "on average", id="average"),
        pytest.param(GOOD + "\n" + "Go on.\n" * 7, "a paragraph of 7 lines", id="paragraph"),
        pytest.param(GOOD + "\n" + "Go on. " * 20 + "\n", "columns", id="columns"),
    ],
)
def test_bad_text_is_found(text: str, fault: str):
    found = find_faults(text)
    assert any(fault in one for one in found), found


@pytest.mark.parametrize(
    "text",
    [
        GOOD,
        GOOD + f"\n```\n{LONG}\n```\n",
        GOOD + f"\n| a |\n| --- |\n| {LONG} |\n",
        GOOD + f"\n## {LONG}\n",
        GOOD + f"\n![{LONG}](a.png)\n",
    ],
    ids=["plain", "code", "table", "heading", "picture"],
)
def test_good_text_passes(text: str):
    assert find_faults(text) == []


def test_long_readme_is_found():
    assert find_faults("\n" * 121, is_readme=True) == ["121 lines of 120"]


def test_sentences_end_where_a_reader_stops():
    text = "By V. Hoffmann, e.g. This one (see 1.2). Is it? `neurotouch run` plays. 12 more."
    sentences = read_paragraphs(text)[0].sentences()
    assert [count_words(one) for one in sentences] == [8, 2, 2, 2]
