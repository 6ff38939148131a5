"""Whatever is asked for, an edit is right or refused in words; a text is never half changed."""

import copy
from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.faults import format_path
from neurotouch_hid.files.yaml_document import parse_document
from neurotouch_hid.profile import check_content
from neurotouch_hid.profile.editing import (
    ProfileText,
    bind,
    list_key_paths,
    parse_do,
    parse_value,
    parse_when,
    reset_value,
    set_value,
    unbind,
)
from neurotouch_hid.profile.editing.key_paths import find_key_path

TEXT = ProfileText("""\
version: 1
name: mine
timing: steady  # patient
bindings:
  # steer
  - when: push
    do: {stick: left, curve: {expo: 0.3}}
  - when: {gesture: pinch, on_mm: 10.0}
    do: {button: a}
layers:
  - name: menu
    bindings:
      - when: zoom
        do: {layer: menu}
""")
DOCUMENT = TEXT.document
PATHS_THERE = sorted(list_key_paths(DOCUMENT))

GESTURES = ("push", "left", "pinch", "tap", "then", "twist", "cw", "from", "7", "mm", "at", "with")
OUTPUTS = ("button", "a", "key", "toggle", "ctrl+c", "axis", "right_x", "-", "+", "layer", "{", "}")
WORDS = st.sampled_from((*GESTURES, *OUTPUTS))
SENTENCES = st.lists(WORDS, max_size=6).map(" ".join) | st.text(max_size=30)
PATHS = st.sampled_from(PATHS_THERE) | st.text(alphabet="abcpush.[]0159#_", max_size=20) | st.text()
NUMBERS = st.integers(-(10**9), 10**9) | st.floats(-1e9, 1e9)
VALUES = st.recursive(
    st.booleans() | NUMBERS | st.text(max_size=12),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3)
    ),
    max_leaves=5,
)


def load(text):
    root, faults = parse_document(text.text)
    assert root is not None
    assert not faults
    return root.value


def put(document, keys, value):
    for key in keys[:-1]:
        document = document.setdefault(key, {}) if isinstance(document, dict) else document[key]
    document[keys[-1]] = value


def widened(found):
    """The document with keys where a word must become some."""
    document = copy.deepcopy(DOCUMENT)
    if found.widen is not None:
        keys, key = found.widen
        word = document
        for step in keys:
            word = word[step]
        put(document, keys, {key: word})
    return document


@settings(max_examples=80)
@given(path=st.sampled_from(PATHS_THERE), value=VALUES)
def test_exactly_the_named_value_changes(path, value):
    found = find_key_path(DOCUMENT, path)
    changed = set_value(TEXT, path, value)
    expected = widened(found)
    put(expected, found.keys, value)
    assert load(changed) == expected
    assert changed.text.count("#") >= 2


@settings(max_examples=80)
@given(path=PATHS, value=st.text(max_size=30))
def test_a_setting_is_right_or_refused(path, value):
    try:
        changed = set_value(TEXT, path, parse_value(value))
    except ProfileError:
        return
    check_content(changed.encode(), "x").format()


@pytest.mark.parametrize("path", PATHS_THERE)
def test_what_is_set_can_be_taken_back(path):
    found = find_key_path(DOCUMENT, path)
    if not found.exists:
        changed = set_value(TEXT, path, "x")
        assert load(reset_value(changed, format_path(found.keys))) == widened(found)


@settings(max_examples=80)
@given(when=SENTENCES, do=SENTENCES)
def test_a_binding_in_words_is_right_or_refused(when, do):
    with suppress(ProfileError):
        changed = bind(TEXT, parse_when(when), parse_do(do))
        load(changed)
        unbind(changed, parse_when(when))
