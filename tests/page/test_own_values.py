"""The person's own values: set on the page, taken back by kind, mended when they are broken."""

from pathlib import Path

import pytest

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.page.own_values import NAMES, OwnValues, describe_values, load_usable_user
from neurotouch_hid.players import find_user_file
from neurotouch_hid.profile import load_user
from neurotouch_hid.profile.calibration import write_ranges
from neurotouch_hid.profile.editing import take_user
from neurotouch_hid.profile.schema.user import MovementRange

USUAL = {
    "filter": "",
    "timing": "",
    "neutral": "lifted",
    "fatigue": "suggest",
    "feedback.sound": "none",
}
BROKEN = "version: 1\nfiltr: strong\n"


@pytest.fixture
def file(tmp_path, monkeypatch) -> Path:
    """The person's file, which is not there yet; no driver runs."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    return find_user_file()


@pytest.fixture
def own() -> OwnValues:
    return OwnValues(lambda: "now")


def read() -> dict[str, str]:
    return describe_values()["values"]


def test_each_value_is_saved_as_the_command_saves_it(file, own):
    assert read() == USUAL
    wanted = dict(zip(NAMES, ["strong", "slow", "resting", "auto", "speech"], strict=True))
    for name, value in wanted.items():
        assert own.set(name, value) == (
            "Saved. No driver is running; it applies from the next start."
        )
    assert read() == wanted
    user = load_user()
    assert (user.filter, user.timing, user.neutral) == ("strong", "slow", "resting")
    assert (user.fatigue, user.feedback.sound) == ("auto", "speech")
    assert own.set("filter", "strong") == "It is so already."
    own.set("filter", "")
    assert load_user().filter is None


def test_undo_goes_back_change_by_change_and_leaves_all_else(file, own):
    file.parent.mkdir(parents=True)
    file.write_text("# Mine.\nversion: 1\nfilter: light\n")
    own.set("filter", "strong")
    own.set("neutral", "resting")
    edited = take_user(lambda: "now_calibration")
    edited.save(
        write_ranges(edited.text, {"pinch": MovementRange(rest=1.0, full=4.0)}, "2026-01-01")
    )
    own.undo()
    assert read() == {**USUAL, "filter": "strong"}
    own.undo()
    assert read() == {**USUAL, "filter": "light"}
    with pytest.raises(ProfileError, match="no change"):
        own.undo()
    assert load_user().range.pinch is not None
    assert file.read_text().startswith("# Mine.\n")


def test_a_calibration_is_undone_and_what_was_chosen_stays(file, own):
    edited = take_user(lambda: "now_calibration")
    edited.save(
        write_ranges(edited.text, {"pinch": MovementRange(rest=1.0, full=4.0)}, "2026-01-01")
    )
    own.set("fatigue", "auto")
    assert own.undo_calibration().startswith("Your range is as before that measurement.")
    assert load_user().range.pinch is None
    assert read()["fatigue"] == "auto"
    with pytest.raises(ProfileError, match="no measurement"):
        own.undo_calibration()


@pytest.mark.parametrize(
    ("name", "value"), [("rotate_deg", "5"), ("filter", "huge"), ("timing", "own"), ("slots", "x")]
)
def test_what_cannot_be_changes_nothing(file, own, name, value):
    with pytest.raises(ProfileError) as caught:
        own.set(name, value)
    assert "^" not in caught.value.message
    assert not file.exists()


def test_times_of_one_s_own_are_named_and_stay(file, own):
    file.parent.mkdir(parents=True)
    file.write_text("version: 1\ntiming: {preset: slow, tap_ms: 900}\n")
    assert read()["timing"] == "own"
    own.set("filter", "light")
    assert "tap_ms: 900" in file.read_text()


def test_a_broken_file_is_told_in_words_and_has_a_way_out(file, own):
    own.set("filter", "light")
    own.set("filter", "strong")
    good = file.read_text()
    file.write_text(BROKEN)
    fault = describe_values()["fault"]
    assert fault.startswith("Your own values cannot be read. Line 2, 'filtr': ")
    assert "^" not in fault
    assert "\n" not in fault
    assert load_usable_user().slots == ["default"]
    assert own.mend().startswith("Your own values are as they were before.")
    assert file.read_text() == good
    with pytest.raises(ProfileError, match="can be read"):
        own.mend()


def test_a_broken_file_without_a_version_is_put_aside(file, own):
    file.parent.mkdir(parents=True)
    file.write_bytes(b"version: 1\n\xff\n")
    assert "fault" in describe_values()
    assert own.mend().startswith("Your own values were put aside")
    assert read() == USUAL
    kept = list(file.parent.glob(".history/user/*.yaml"))
    assert [path.read_bytes() for path in kept] == [b"version: 1\n\xff\n"]
