"""The glossary: at most forty words, in order, each used."""

import re
import tomllib

import pytest

from tests.docs.prose import ROOT
from tests.processes import run_command

GLOSSARY = ROOT / "docs" / "glossary.md"
TERMS = re.findall(r"^([a-z][a-z -]+)\n: ", GLOSSARY.read_text(encoding="utf-8"), re.MULTILINE)

PLACES = (
    "neurotouch_hid",
    "devtools",
    "docs",
    "examples",
    "packaging",
    "profiles",
    "udev",
    "README.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
)
_GAP = r"(?:[\s_]|\s*#\s*)+"  # also a comment that goes on in the next line
LIST = tomllib.loads((ROOT / "tests" / "docs" / "private_words.toml").read_text(encoding="utf-8"))
INSTEAD = list(LIST["words"].values())
PRIVATE = re.compile(
    r"(?<![a-z])(?:"
    + "|".join(f"({words.replace(' ', _GAP)})" for words in LIST["words"])
    + r")(?![a-z])",
    re.IGNORECASE,
)


def test_forty_terms_in_order():
    assert 30 <= len(TERMS) <= 40
    assert sorted(TERMS) == TERMS


def test_every_term_is_used_in_the_program_and_on_a_page():
    pages = ["README.md", "docs/*.md", ":!docs/glossary.md"]
    unused = [
        term
        for term in TERMS
        for places in (["neurotouch_hid"], pages)
        if len(find_files_with(term, places)) < 2  # once may be chance
    ]
    assert unused == []


def find_files_with(term: str, places: list[str]) -> list[str]:
    words = term.replace(" ", "[ _]").replace("-", "-?")
    found = run_command(
        "git", "grep", "-lwiE", f"{words}(e?s)?", "--", *places, code=None, cwd=ROOT
    )
    return found.stdout.splitlines()


def test_no_private_words():
    found = [
        line
        for path in list_texts()
        if path not in LIST["allowed"]
        for line in find_private(path, (ROOT / path).read_text("utf-8"))
    ]
    assert found == [], "\n".join(found)


def test_allowed_files_exist_and_need_it():
    for path in LIST["allowed"]:
        assert find_private(path, (ROOT / path).read_text("utf-8")), path


@pytest.mark.parametrize(
    "text",
    [
        "# begins anew",
        "It lets go\nof all.",
        "def looks_on():",
        "Usual hand: 3 mm",
        "# It waits for\n# so long.",
        "The way out",
    ],
)
def test_private_word_is_found(text: str):
    assert len(find_private("a.py", text)) == 1


@pytest.mark.parametrize(
    "text", ["letters", "a renewal", "lullaby", "It looks online.", "so long as"]
)
def test_ordinary_word_is_not(text: str):
    assert find_private("a.py", text) == []


def list_texts() -> list[str]:
    """All text files of ``PLACES``, from the repository's root."""
    command = ["git", "grep", "-I", "--name-only", "-e", "", "--", *PLACES]
    done = run_command(*command, cwd=ROOT)
    return [path for path in done.stdout.splitlines() if not path.endswith((".svg", ".lock"))]


def find_private(path: str, text: str) -> list[str]:
    """Every private word of a text, with its line and what to write instead."""
    return [
        f"{path}:{text.count(chr(10), 0, match.start()) + 1}: not '{match[0]}' but "
        + INSTEAD[(match.lastindex or 0) - 1]
        for match in PRIVATE.finditer(text)
    ]
