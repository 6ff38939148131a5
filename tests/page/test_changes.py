"""What the page shows of a profile, and what dragging changes in its file."""

import math
from pathlib import Path

import pytest

from neurotouch_hid.errors import PageError, ProfileError
from neurotouch_hid.page.edits import Changes, Wish
from neurotouch_hid.page.profile_view import MOVEMENTS, describe_profile, is_editable, measure_lag
from neurotouch_hid.profile import list_profiles, load_profile
from neurotouch_hid.profile.reading.library import find_shipped_folder, find_user_folder

LAYERS = """\
version: 1
name: mine
bindings:
  - {when: push, do: {stick: left, curve: {power: 2}}}   # walk
  - when: {gesture: pinch, on_mm: 4}
    do: {layer: menu}
layers:
  - name: menu
    below: empty
    bindings:
      - when: {gesture: push, direction: up_left}
        do: {button: a}
      # the way out
      - {when: pinch, do: {layer: base}}
"""


@pytest.fixture
def mine(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    path = find_user_folder() / "mine.yaml"
    path.parent.mkdir(parents=True)
    path.write_text(LAYERS)
    return path.resolve()


@pytest.fixture
def changes() -> Changes:
    return Changes(lambda: "now")


@pytest.mark.parametrize("name", list_profiles())
def test_every_shipped_profile_can_be_shown(name):
    about = describe_profile(list_profiles()[name].resolve(), edit=True)
    assert about["profile"] == name
    assert about["shipped"]
    assert about["edit"]
    for layer in about["layers"]:
        for binding in layer["bindings"]:
            assert binding["key"]
            assert set(binding["movements"]) <= set(MOVEMENTS)
            if "samples" in binding:
                assert binding["samples"] == sorted(binding["samples"])
                assert binding["samples"][0] == 0.0
                assert binding["rest"] < binding["full"] < binding["most"]


def test_layers_and_directions(mine):
    base, menu = describe_profile(mine, edit=False)["layers"]
    assert [each["key"] for each in base["bindings"]] == ["push", "pinch"]
    assert base["bindings"][0]["movements"] == list(MOVEMENTS[:4])
    assert base["bindings"][0]["curve"] == {"power": 2.0}
    assert (base["bindings"][1]["on_mm"], base["bindings"][1]["off_mm"]) == (4.0, 2.4)
    assert menu["bindings"][0]["key"] == "layers.menu.push_up_left"
    assert menu["bindings"][0]["movements"] == ["push_left", "push_up"]


def test_what_is_built_on_another_profile_shows_it_but_edits_only_its_own(mine):
    path = mine.with_name("mine2.yaml")
    path.write_text(
        "version: 1\nname: mine2\nextends: [mine]\nbindings:\n  - {when: zoom, do: {button: b}}\n"
    )
    bindings = describe_profile(path, edit=True)["layers"][0]["bindings"]
    keys = {each["when"]: each["key"] for each in bindings}
    assert keys["zoom"] == "zoom"
    assert keys["push"] is None


@pytest.mark.parametrize(
    ("key", "mark", "value", "old", "new", "words"),
    [
        ("pinch", "on_mm", 5.04, "on_mm: 4}", "on_mm: 5.0}", "acts from 5 mm"),
        ("pinch", "off_mm", 2, "on_mm: 4}", "on_mm: 4, off_mm: 2}", "releases below 2 mm"),
        ("push", "power", 1.5, "power: 2}", "power: 1.5}", "has a bend of 1.5"),
        ("push", "full", 6, "{power: 2}}}", "{power: 2}, range_mm: [1.0, 6]}}", "ends at 6 mm"),
        ("push", "expo", 0.25, "{power: 2}", "{expo: 0.25}", "has a bend of 0.25"),
        (
            *("push", "points", [[0.5, 0.2]], "{power: 2}", "{points: [[0.5, 0.2]]}"),
            "has a curve of its own",
        ),
        (
            "layers.menu.push_up_left",
            "on_mm",
            3,
            "direction: up_left}",
            "direction: up_left, on_mm: 3}",
            "push up left",
        ),
    ],
)
def test_a_mark_changes_one_line_and_undo_brings_it_back(
    mine, changes, key, mark, value, old, new, words
):
    said = changes.set(mine, key, mark, value)
    assert said.startswith("Saved in mine: ")
    assert words in said
    changed = mine.read_text()
    before, after = LAYERS.splitlines(), changed.splitlines()
    different = [(a, b) for a, b in zip(before, after, strict=True) if a != b]
    assert len(different) == 1
    assert different[0][1].replace(".0", "") == different[0][0].replace(old, new).replace(".0", "")
    load_profile(mine)
    changes.undo(mine)
    assert mine.read_text() == LAYERS


def test_each_undo_says_which_binding_it_changes(mine, changes, monkeypatch, tmp_path):
    """The same words twice would leave open what the second press has undone."""
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    changes.set(mine, "pinch", "on_mm", 3)
    changes.bind(mine, Wish("zoom", "tap", "", "button b", "", ""))
    assert changes.undo(mine).startswith("Removed: zoom tap → button b. mine is as before ")
    assert changes.undo(mine).startswith("Back: pinch from 4 mm → toggle layer menu. mine is ")
    mine.write_text(LAYERS.replace("version: 1", "version: 1\ndescription: mine"))
    assert changes.undo(mine).startswith("mine is as before that change.")
    mine.write_text("bindings: [")
    assert changes.undo(mine).startswith("mine is as before that change.")


def test_a_shipped_profile_is_copied_and_stays(mine, changes):
    shipped = (find_shipped_folder() / "default.yaml").resolve()
    before = shipped.read_bytes()
    changes.set(shipped, "zoom", "full", 3.0)
    assert shipped.read_bytes() == before
    own = find_user_folder() / "default.yaml"
    assert load_profile(own).bindings[3].do.range_mm == (1.0, 3.0)
    assert "# Zoom (fingers apart)" in own.read_text()


@pytest.mark.parametrize(
    ("key", "mark", "value"),
    [
        ("pinch", "on_mm", 0.2),
        ("pinch", "off_mm", 9),
        ("pinch", "on_mm", math.nan),
        ("pinch", "on_mm", math.inf),
        ("pinch", "on_mm", 1e308),
        ("pinch", "on_mm", True),
        ("pinch", "on_mm", None),
        ("pinch", "name", 1),
        ("name", "on_mm", 1),
        ("zoom", "on_mm", 3),
        ("push", "points", []),
        ("push", "points", [[0.5, 0.5], [0.2, 0.9]]),
        ("push", "full", 1.2),
    ],
)
def test_what_cannot_be_changes_nothing(mine, changes, key, mark, value):
    with pytest.raises((ProfileError, PageError)):
        changes.set(mine, key, mark, value)
    assert mine.read_text() == LAYERS


def test_a_profile_elsewhere_is_shown_and_never_changed(mine, changes, tmp_path):
    path = tmp_path / "elsewhere.yaml"
    path.write_text(LAYERS)
    assert not is_editable(path)
    assert not describe_profile(path, edit=True)["edit"]
    with pytest.raises(ProfileError, match="outside"):
        changes.set(path, "pinch", "on_mm", 5)
    with pytest.raises(ProfileError, match="outside"):
        changes.undo(path)
    assert path.read_text() == LAYERS


@pytest.mark.parametrize(("name", "ms"), [("none", 0), ("light", 13), ("medium", 40)])
def test_a_filters_lag_is_what_its_table_says(name, ms):
    assert measure_lag(name) == pytest.approx(ms, abs=1.0)


def test_what_does_not_play_yet_is_told_in_the_page_s_words(mine, changes, monkeypatch, tmp_path):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    wish = Wish("pinch", "", "", "button b", "", "")
    for said in (changes.bind(mine, wish), changes.undo(mine)):
        assert "To play it: choose mine under Profile, then 'Play with it'." in said
        assert "  " not in said
        assert "neurotouch" not in said
