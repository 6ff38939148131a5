"""Other packages use the profile through the names that its packages offer."""

import sys
from importlib import import_module

import pytest

from tests.processes import run_command

FACES = ("calibration", "diagnostics", "editing", "engine", "reading", "rehearsal", "schema")


@pytest.mark.parametrize("face", ["", *(f".{face}" for face in FACES)])
def test_every_name_that_is_offered_is_there(face):
    module = import_module(f"neurotouch_hid.profile{face}")
    for name in module.__all__:
        assert getattr(module, name) is not None
    with pytest.raises(AttributeError, match="nonsense"):
        _ = module.nonsense


@pytest.mark.parametrize(
    ("line", "unneeded"),
    [
        ("from neurotouch_hid.profile.reading import list_profiles", {"pydantic", "numpy"}),
        ("from neurotouch_hid.profile.schema import MOVEMENTS", {"pydantic", "numpy"}),
        ("from neurotouch_hid.profile.diagnostics import explain", {"pydantic", "numpy"}),
        ("from neurotouch_hid.profile.editing import Store", {"pydantic", "ruamel", "numpy"}),
        ("from neurotouch_hid.profile.engine import make_response", {"numpy"}),
        ("from neurotouch_hid.profile.editing import set_value", {"numpy"}),
    ],
)
def test_a_name_loads_only_its_own_module(line, unneeded):
    code = f"{line}; import sys; print(*sorted({unneeded!r} & sys.modules.keys()))"
    done = run_command(sys.executable, "-c", code)
    assert done.stdout.split() == []
