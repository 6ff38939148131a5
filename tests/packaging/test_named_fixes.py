"""The fixes that an answer names are read as a person reads them."""

import pytest

from tests.packaging.named_fixes import read_fixes

GAPS = {"FILE": "mine", "KEY": "timing"}


@pytest.mark.parametrize(
    ("call", "answer", "fixes"),
    [
        ("neurotouch rnu", "Fix: Did you mean: neurotouch run", ["neurotouch run"]),
        (
            "neurotouch status",
            "Start it: neurotouch run. Without a camera: neurotouch demo",
            ["neurotouch run", "neurotouch demo"],
        ),
        (
            "neurotouch x",
            "Fix: Leave out, or: neurotouch a --b 'c, d', then e.",
            ["neurotouch a --b 'c, d'"],
        ),
        (
            "neurotouch x",
            "Fix: neurotouch profile set user KEY --default",
            ["neurotouch profile set user timing --default"],
        ),
        (
            "neurotouch x",
            "Fix: neurotouch profile import friend.yaml.",
            ["neurotouch profile import friend.yaml"],
        ),
        (
            "neurotouch run --secnds 3",
            "Fix: Did you mean --seconds?",
            ["neurotouch run --seconds 3"],
        ),
        (
            "neurotouch run --source sim:tuor",
            "Fix: Did you mean sim:tour?",
            ["neurotouch run --source sim:tour"],
        ),
        (
            "neurotouch simulate play",
            "Fix: Choose another folder, or --force to replace it.",
            ["neurotouch simulate play --force"],
        ),
        (
            "neurotouch view --port 80 --edit",
            "Fix: Use one of 1024 or more: --port 7900",
            ["neurotouch view --port 7900 --edit"],
        ),
        (
            "neurotouch profile import --user me.yaml --name other",
            "Fix: Leave --name away: your own values have no name.",
            ["neurotouch profile import --user me.yaml"],
        ),
        ("neurotouch x", "Fix: man neurotouch-service has all; see /var/cache/neurotouch", []),
        ("neurotouch x", "All is well: neurotouch is here.", []),
    ],
)
def test_fixes_are_read(call, answer, fixes):
    assert read_fixes(call, f"Error: no.\r\n{answer}\r\n", GAPS) == fixes
