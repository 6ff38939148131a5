"""The page of tricks lists them all, and each with a test that is there."""

import re
from importlib import import_module
from pathlib import Path

from tests.docs.prose import ROOT

PAGE = (ROOT / "docs/develop/process-tricks.md").read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in row.strip("|").split(" | ")]
    for row in PAGE.splitlines()
    if row.startswith("| `")
]
HERE = Path(__file__).parent
PACKAGE = ROOT / "neurotouch_hid"


def test_every_trick_is_there_and_has_its_test():
    assert len(ROWS) >= 10
    for trick, does, without, test in ROWS:
        assert does
        assert without
        module, _, function = trick.strip("`").partition(".")
        found = import_module(f"neurotouch_hid.process.{module}")
        assert not function or callable(getattr(found, function)), trick
        file, _, name = test.strip("`").partition("::")
        assert f"def {name}(" in (HERE / file).read_text(encoding="utf-8"), test


def test_no_module_that_others_use_is_missing():
    """Of ``startup`` and of any later module like it, no function either."""
    text = "\n".join(path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py"))
    used = set(re.findall(r"from neurotouch_hid\.process\.(\w+) import", text))
    inner = "\n".join(path.read_text(encoding="utf-8") for path in PACKAGE.glob("process/*.py"))
    within = set(re.findall(r"from neurotouch_hid\.process\.(\w+) import", inner))
    named = {row[0].strip("`").partition(".")[0] for row in ROWS} | {"signals"}
    assert used - within <= named
    startup = (PACKAGE / "process/startup.py").read_text(encoding="utf-8")
    functions = re.findall(r"^def (\w+)", startup, re.MULTILINE)
    assert {f"`startup.{name}`" for name in functions} <= {row[0] for row in ROWS}
