"""The glossary: at most forty words, in order, each used."""

import re
import subprocess

from tests.docs.prose import ROOT

GLOSSARY = ROOT / "docs" / "glossary.md"
TERMS = re.findall(r"^([a-z][a-z -]+)\n: ", GLOSSARY.read_text(encoding="utf-8"), re.MULTILINE)

PRIVATE = {
    "anew": "again",
    "usual hand": "reference hand",
    "lets go of everything": "releases everything",
    "looks on": "watches",
    "look on": "watch",
    "looking on": "watching",
    "of late": "recently",
    "takes notice": "records",
    "lull": "idle slices",
    "outbox": "packet queue",
    "mailbox": "command queue",
}
"""Words of our own, and what to write instead."""
STRICT = ("docs", "README.md", "CONTRIBUTING.md", "neurotouch_hid/runtime", "neurotouch_hid/gel.py")
NOTEBOOKS = ("docs/research/notebook", "docs/glossary.md", "docs/develop/decisions")


def test_forty_terms_in_order():
    assert 30 <= len(TERMS) <= 40
    assert sorted(TERMS) == TERMS


def test_every_term_is_used():
    unused = [
        term
        for term in TERMS
        if subprocess.run(
            ["git", "grep", "-qiE", term.replace("-", ".?"), "--", ":!docs/glossary.md"],
            cwd=ROOT,
            check=False,
        ).returncode
        != 0
    ]
    assert unused == []


def test_no_private_words_where_people_read_first():
    found = subprocess.run(
        ["git", "grep", "-niwE", "|".join(PRIVATE), "--", *STRICT],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    ).stdout.splitlines()
    wrong = [line for line in found if not line.startswith(NOTEBOOKS)]
    assert wrong == [], f"write instead: {PRIVATE}"
