"""Reads Markdown as a person does: sentences and paragraphs, without code, tables and headings."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token

ROOT = Path(__file__).parents[2]
ADMONITIONS = {"{warning}", "{note}", "{tip}", "{important}", "{caution}", "{hint}"}

AVERAGE_WORDS = 17
MOST_WORDS = 30
MOST_LINES = 6
MOST_COLUMNS = 120
README_LINES = 120

# A sentence ends before a space and a beginning. "V. Hoffmann" and "e.g. this" go on.
_END = re.compile(r"""(?<![A-Z]\.)(?<!e\.g\.)(?<=[.!?])["')\]]*\s+(?=["'(\[]*[A-Z0-9`])""")
_WORD = re.compile(r"\w")


@dataclass(frozen=True)
class Paragraph:
    """A paragraph, an item of a list or a quotation.

    Attributes:
        line: where it begins in its file, from 1.
        source: as it is written.
        words: as it is read; code in a line is one word.
    """

    line: int
    source: str
    words: str

    def sentences(self) -> list[str]:
        return [sentence for sentence in _END.split(self.words) if _WORD.search(sentence)]


def pages() -> list[Path]:
    """All documents for people, from the repository's root."""
    top = ["README.md", "CONTRIBUTING.md", "SECURITY.md"]
    docs = ROOT / "docs"
    inside = [page for page in sorted(docs.rglob("*.md")) if "_build" not in page.parts]
    inside.remove(docs / "contributing.md")  # it shows the one at the top
    return [ROOT / name for name in top] + inside


def read_paragraphs(text: str) -> list[Paragraph]:
    return list(_paragraphs(text, 0))


def count_words(sentence: str) -> int:
    return sum(1 for word in sentence.split() if _WORD.search(word))


def find_faults(text: str, *, is_readme: bool = False) -> list[str]:
    """Everything in a document that is against the rules, a sentence each."""
    faults = [] if is_readme or names_reader(text) else ["no line 'For ...' below the title"]
    if is_readme and text.count("\n") > README_LINES:
        faults.append(f"{text.count(chr(10))} lines of {README_LINES}")
    paragraphs = read_paragraphs(text)
    for paragraph in paragraphs:
        faults += _measure(paragraph)
    lengths = [count_words(one) for paragraph in paragraphs for one in paragraph.sentences()]
    average = sum(lengths) / max(1, len(lengths))
    if average > AVERAGE_WORDS:
        faults.append(f"{average:.1f} words a sentence on average, {AVERAGE_WORDS} are allowed")
    return faults


def names_reader(text: str) -> bool:
    """Whether the first paragraph says for whom the page is, and what one can do after it."""
    paragraphs = read_paragraphs(text)
    first = paragraphs[0].words.lstrip("*_ ") if paragraphs else ""
    return first.startswith("For ") and bool(re.search(r"\bafter\b", first, re.IGNORECASE))


def _measure(paragraph: Paragraph) -> Iterator[str]:
    lines = paragraph.source.splitlines()
    if len(lines) > MOST_LINES:
        yield f"line {paragraph.line}: a paragraph of {len(lines)} lines, {MOST_LINES} are allowed"
    for i, line in enumerate(lines):
        if len(line) > MOST_COLUMNS:
            yield f"line {paragraph.line + i}: {len(line)} columns, {MOST_COLUMNS} are allowed"
    for sentence in paragraph.sentences():
        if (words := count_words(sentence)) > MOST_WORDS:
            yield f"line {paragraph.line}: a sentence of {words} words: {sentence[:60]} ..."


def _paragraphs(text: str, above: int) -> Iterator[Paragraph]:
    lines = text.splitlines()
    tokens = MarkdownIt("commonmark").enable("table").parse(text)
    for before, token in pairwise(tokens):
        if token.type == "inline" and before.type == "paragraph_open" and token.map:
            begin, end = token.map
            words = "".join(_read(child) for child in token.children or ())
            if _WORD.search(words):
                yield Paragraph(above + begin + 1, "\n".join(lines[begin:end]), words)
    for token in tokens:
        if token.type == "fence" and token.info.split(" ")[0] in ADMONITIONS and token.map:
            inner = re.sub(r"^:\w.*$", "", token.content, flags=re.MULTILINE)
            yield from _paragraphs(inner, above + token.map[0] + 1)


def _read(token: Token) -> str:
    if token.type == "code_inline":
        return "`code`" + re.sub(r".*?([.!?]?)$", r"\1", token.content[-1:])
    if token.type in ("softbreak", "hardbreak"):
        return " "
    return token.content if token.type == "text" else ""
