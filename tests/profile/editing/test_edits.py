"""Values, bindings and versions as people ask for them."""

import pytest
from ruamel.yaml import YAML

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.yaml_document import parse_document
from neurotouch_hid.profile import check_content, check_profile
from neurotouch_hid.profile.diagnostics.description import describe_target, describe_when
from neurotouch_hid.profile.editing import (
    ProfileText,
    adopt,
    bind,
    compare,
    list_company,
    list_key_paths,
    parse_do,
    parse_when,
    reset_value,
    set_value,
    take_profile,
    unbind,
    upgrade,
)
from neurotouch_hid.profile.editing.key_paths import find_key_path
from neurotouch_hid.profile.editing.questions import list_questions
from neurotouch_hid.profile.editing.summary import summarize_binding
from neurotouch_hid.profile.reading.library import find_shipped_folder
from neurotouch_hid.profile.schema.profile import Binding
from neurotouch_hid.profile.schema.user import UserSettings

NAMES = sorted(path.stem for path in find_shipped_folder().glob("*.yaml"))

TEXT = ProfileText("""\
# mine
version: 1
name: mine

bindings:
  # steer
  - when: push  # all ways
    do: {stick: left, curve: {expo: 0.3}}
  - when: {gesture: pinch, on_mm: 10.0, off_mm: 7.0}
    do: {button: a}
  - when: pinch
    do: {trigger: left}

layers:
  - name: menu
    bindings:
      - when: {gesture: push, direction: left, press: tap}
        do: {dpad: left}
      - when: zoom
        do: {layer: menu}
""")


def load(text):
    return parse_document(text.text)[0].value


def added(before, after):
    return [text.strip() for verb, _, text in compare(before, after) if verb == "added"]


@pytest.mark.parametrize(
    ("path", "value", "line"),
    [
        ("push.curve.expo", 0.5, "do: {stick: left, curve: {expo: 0.5}}"),
        ("bindings[0].do.curve.expo", 0.5, "do: {stick: left, curve: {expo: 0.5}}"),
        ("bindings.0.curve.expo", 0.5, "do: {stick: left, curve: {expo: 0.5}}"),
        ("push.gain", 2.0, "do: {stick: left, curve: {expo: 0.3}, gain: 2.0}"),
        ("push.on_mm", 3.0, "- when: {gesture: push, on_mm: 3.0}  # all ways"),
        ("pinch.button", "b", "do: {button: b}"),
        ("pinch#2.gain", 2.0, "do: {trigger: left, gain: 2.0}"),
        ("layers.menu.push_left_tap.dpad", "up", "do: {dpad: up}"),
        ("timing", "slow", "timing: slow"),
        ("timing.hold_ms", 600, "timing: {hold_ms: 600}"),
        ("safety.pause.gesture", "zoom", "safety: {pause: {gesture: zoom}}"),
        ("description", "Mine: all of it", 'description: "Mine: all of it"'),
    ],
)
def test_setting_a_value_changes_one_line(path, value, line):
    changed = set_value(TEXT, path, value)
    assert added(TEXT, changed) == [line]
    assert len(compare(TEXT, changed)) <= 2


@pytest.mark.parametrize(
    ("path", "value"), [("pinch.button", "b"), ("push.gain", 2.0), ("push.on_mm", 3.0)]
)
def test_a_text_is_parsed_once_to_set_a_value_in_it(path, value, monkeypatch):
    parsed = []
    for name in ("parse", "compose"):
        real = getattr(YAML, name)
        monkeypatch.setattr(
            YAML, name, lambda self, text, real=real: (parsed.append(text), real(self, text))[1]
        )
    text = ProfileText(TEXT.text)
    set_value(text, path, value)
    assert parsed == [text.text, text.text]  # its values, then their places; the new text waits
    set_value(text, "timing", "slow")
    assert len(parsed) == 2


def test_a_word_becomes_keys_where_they_are_needed():
    changed = set_value(set_value(TEXT, "timing", "steady"), "timing.hold_ms", 900)
    assert load(changed)["timing"] == {"preset": "steady", "hold_ms": 900}


def test_new_keys_stand_where_keys_of_their_kind_stand():
    changed = set_value(TEXT, "timing", "slow")
    assert changed.text.index("timing") < changed.text.index("bindings")


@pytest.mark.parametrize("path", ["psh.gain", "push.gian", "layers.x.zoom", "a..b", "", "[0]", "."])
def test_a_wrong_path_is_refused_with_a_way_out(path):
    with pytest.raises(ProfileError) as caught:
        set_value(TEXT, path, 1)
    assert caught.value.hint


@pytest.mark.parametrize(
    ("path", "meant"),
    [
        ("push.gian", "push.gain"),
        ("push.curve.exp", "push.curve.expo"),
        ("psh.curve.expo", "push.curve.expo"),
        ("layers.meun.zoom.on_mm", "layers.menu.zoom.on_mm"),
    ],
)
def test_the_whole_path_is_suggested(path, meant):
    with pytest.raises(ProfileError) as caught:
        set_value(TEXT, path, 1)
    assert caught.value.hint == f"Did you mean '{meant}'?"


def test_no_path_is_suggested_that_leads_nowhere():
    with pytest.raises(ProfileError) as caught:
        set_value(ProfileText("name: mine\n"), "layers.menu.zoom.on_mm", 1)
    assert caught.value.hint == "There is no 'menu' in 'layers' yet."


def test_a_default_comes_back():
    changed = reset_value(TEXT, "push.curve")
    assert added(TEXT, changed) == ["do: {stick: left}"]
    assert reset_value(TEXT, "push.gain") == TEXT


def test_the_users_own_values_are_set_in_the_same_way():
    text = ProfileText("version: 1\n")
    text = set_value(text, "range.zoom", {"rest": 0.6, "full": 3.0}, UserSettings)
    text = set_value(text, "range.pinch.full", 5.0, UserSettings)
    text = set_value(text, "filter", "medium", UserSettings)
    assert load(text) == {
        "version": 1,
        "range": {"zoom": {"rest": 0.6, "full": 3.0}, "pinch": {"full": 5.0}},
        "filter": "medium",
    }


@pytest.mark.parametrize("name", NAMES)
def test_every_path_that_completion_offers_leads_somewhere(name):
    document = take_profile(name, str).text.document
    paths = list(list_key_paths(document))
    assert len(paths) > 20
    for path in paths:
        find_key_path(document, path)


def test_a_binding_for_the_same_gesture_does_something_else():
    changed = bind(TEXT, parse_when("pinch from 10 mm"), parse_do("toggle button b"))
    assert added(TEXT, changed) == ["do: {button: b, mode: toggle}"]


def test_another_gesture_is_a_further_binding():
    changed = bind(TEXT, parse_when("twist cw"), parse_do("axis right x -"))
    assert added(TEXT, changed) == ["- when: twist_cw", 'do: {axis: right_x, sign: "-"}']
    assert len(load(changed)["bindings"]) == 4
    twice = bind(TEXT, "push", parse_do("key a"), add=True)
    assert [b["when"] for b in load(twice)["bindings"]].count("push") == 2
    inside = bind(TEXT, "pinch", parse_do("button x"), "menu")
    assert load(inside)["layers"][0]["bindings"][-1] == {"when": "pinch", "do": {"button": "x"}}


def test_a_profile_without_bindings_gets_some():
    text = ProfileText("version: 1\nname: mine\nextends: [racing]\n")
    assert load(bind(text, "pinch", {"button": "a"}))["bindings"] == [
        {"when": "pinch", "do": {"button": "a"}}
    ]


def test_a_threshold_that_nobody_said_does_not_hide_a_binding():
    text = ProfileText(
        "bindings:\n"
        "  - when: {gesture: pinch, on_mm: 7.0}\n    do: {button: a}\n"
        "  - when: push\n    do: {stick: left}\n"
    )
    changed = load(bind(text, "pinch", {"button": "b"}))["bindings"]
    assert changed[0] == {"when": {"gesture": "pinch", "on_mm": 7.0}, "do": {"button": "b"}}
    assert len(changed) == 2
    assert list_company(text, "pinch") == []
    both = bind(text, "pinch", {"button": "b"}, add=True)
    assert list_company(both, "pinch", added=True) == ["pinch (button a)"]
    assert [b["when"] for b in load(unbind(text, "pinch"))["bindings"]] == ["push"]
    two = bind(text, parse_when("pinch from 3 mm"), {"button": "x"})
    assert len(load(two)["bindings"]) == 3
    with pytest.raises(ProfileError, match="several bindings"):
        bind(two, "pinch", {"button": "y"})
    assert load(unbind(two, "pinch#2")) == load(text)
    assert load(unbind(two, parse_when("pinch from 3 mm"))) == load(text)
    with pytest.raises(ProfileError, match="no such binding"):
        unbind(text, "pinch#2")


def test_unbinding_takes_what_was_named():
    changed = unbind(TEXT, parse_when("pinch"))
    assert [b["when"] for b in load(changed)["bindings"]] == [
        "push",
        {"gesture": "pinch", "on_mm": 10.0, "off_mm": 7.0},
    ]
    with pytest.raises(ProfileError, match="no such binding"):
        unbind(TEXT, parse_when("pinch"), parse_do("button b"))
    with pytest.raises(ProfileError, match="no layer"):
        unbind(TEXT, "pinch", layer="other")
    only = ProfileText("bindings:\n  - when: push\n    do: {stick: left}\n")
    with pytest.raises(ProfileError, match="last binding"):
        unbind(only, "push")


@pytest.mark.parametrize("name", NAMES)
def test_words_for_a_binding_mean_that_binding(name):
    profile = check_profile(find_shipped_folder() / f"{name}.yaml").written
    for layer in profile.all_layers:
        for binding in layer.bindings:
            when = binding.when
            written = when if isinstance(when, str) else when.model_dump(exclude_unset=True)
            spoken = parse_when(describe_when(binding))
            if isinstance(written, dict):
                unsaid = ("off_mm", "hold_ms", "within_ms", "accept_ms", "release", "sectors")
                written = {key: v for key, v in written.items() if key not in unsaid}
                written = written["gesture"] if [*written] == ["gesture"] else written
            assert spoken == written
            do = binding.do.model_dump(mode="json")
            for key, value in parse_do(describe_target(binding.do)).items():
                assert do[key] == value


@pytest.mark.parametrize("words", ["", "pusch", "pinch twice", "push left right", "tap", "12 mm"])
def test_words_that_are_no_gesture_are_refused(words):
    with pytest.raises(ProfileError) as caught:
        parse_when(words)
    assert caught.value.hint


@pytest.mark.parametrize("words", ["", "a", "button", "knob a", "toggle", "rm -rf /", "$(x)"])
def test_words_that_are_no_output_are_refused(words):
    with pytest.raises(ProfileError):
        parse_do(words)


def test_an_old_file_is_brought_up_to_date():
    old = ProfileText("name: mine\nbindings:\n  - when: push\n    do: {stick: left}\n")
    new = upgrade(old, "schema/profile-1.json")
    assert new.text.startswith(
        "# yaml-language-server: $schema=schema/profile-1.json\nversion: 1\nname"
    )
    assert check_content(new.encode(), "x").whole is not None
    assert upgrade(new, "schema/profile-1.json") == new
    with pytest.raises(ProfileError, match="version 2"):
        upgrade(new.replace(("version",), 2), "x")


def test_a_copy_gets_its_own_name_and_schema_line():
    text = "# yaml-language-server: $schema=a.json\r\nversion: 1\r\nname: a\r\n"
    copied = text.replace("a.json", "c.json").replace(": a", ": b")
    assert adopt(ProfileText(text), "b", "c.json").text == copied


def test_a_summary_says_every_key_of_a_binding_once():
    when = {"gesture": "pinch", "with_button": "x", "trigger": "release"}
    binding = Binding.model_validate({"when": when, "do": {"trigger": "left", "value": 1.0}})
    assert summarize_binding(binding) == (
        "pinch while x is held -> trigger left, trigger release, pressed to 100 %"
    )
    assert "trigger" in [question.key for question in list_questions(binding)]
