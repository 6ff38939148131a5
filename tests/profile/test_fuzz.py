"""Whatever text comes in: a profile or a located ProfileError, never anything else."""

import re

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ruamel.yaml import YAML

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.yaml_document import parse_document
from neurotouch_hid.profile.reading.library import find_shipped_folder
from neurotouch_hid.profile.reading.load import check_user, parse_profile

LOCATED = re.compile(r"p\.yaml:[1-9]\d*:[1-9]\d*: error\[NT1\d\d\]: \S")
SHIPPED = [path.read_text(encoding="utf-8") for path in find_shipped_folder().glob("*.yaml")]
RELAXED = settings(
    max_examples=150,
    derandomize=True,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)

TOKENS = [
    *"{}[],:-?&*!|>%@`#'\"\n\t \\~<=.",
    *("\n  ", "\n    ", ": ", "- ", "? ", "---\n", "...\n", "<<", "&a ", "*a", "!!int ", "\r\n"),
    *("version", "name", "bindings", "when", "do", "push", "stick", "left", "curve", "range_mm"),
    *("1", "0x1F", "1e999", ".nan", "-.inf", "true", "no", "null", "2020-99-99", "1_000", "'"),
    *("\\U99999999", '"\\x', '"\\uD800"', "\ud7ff", "\u2028", "\x85", "\ufeff", "\x00", "🙂"),
]


def check(content: bytes) -> None:
    try:
        parse_profile(content, "p.yaml")
    except ProfileError as error:
        message = error.message
    else:
        return
    assert LOCATED.match(message), message
    assert all(line.isprintable() for line in message.split("\n"))


@RELAXED
@given(st.lists(st.sampled_from(TOKENS), max_size=60).map("".join))
def test_yaml_like_text(text: str) -> None:
    check(text.encode())


@RELAXED
@given(st.binary(max_size=200))
def test_bytes(content: bytes) -> None:
    check(content)


@RELAXED
@given(
    st.sampled_from(SHIPPED),
    st.lists(
        st.tuples(st.floats(0, 1), st.integers(0, 12), st.sampled_from(["", *TOKENS])), max_size=4
    ),
)
def test_shipped_profiles_with_slips(text: str, edits: list[tuple[float, int, str]]) -> None:
    for place, cut, insert in edits:
        start = int(place * len(text))
        text = text[:start] + insert + text[start + cut :]
    check(text.encode())


VALUES = st.recursive(
    st.one_of(
        st.booleans(),
        st.integers(),
        st.floats(),
        st.sampled_from(["push", "pinch", "left", "a", "linear", "+", "x"]),
        st.text(st.characters(codec="utf-8", exclude_categories=["C", "Z"]), max_size=8),
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3),
        st.dictionaries(
            st.sampled_from(
                [
                    *("version", "name", "bindings", "when", "do", "gesture", "direction"),
                    *("contacts", "on_mm", "off_mm", "stick", "axis", "sign", "trigger"),
                    *("button", "dpad", "range_mm", "deadzone", "curve", "expo", "power", "oops"),
                    *("key", "mouse", "layer", "command", "mode", "repeat", "press", "zone"),
                    *("sequence", "within_ms", "points", "centre_mm", "value", "follow"),
                    *("layers", "below", "release", "drop", "level", "hold_ms", "extends"),
                    *("<stick>", "<word>", "[key]", "0"),
                ]
            ),
            inner,
            max_size=4,
        ),
    ),
    max_leaves=12,
)


def write_flow(value: object) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key!r}: {write_flow(v)}" for key, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(write_flow(v) for v in value) + "]"
    if isinstance(value, str):
        return "'" + value.replace("'", "''") + "'"
    if isinstance(value, float):
        return {"nan": ".nan", "inf": ".inf", "-inf": "-.inf"}.get(str(value), str(value))
    return str(value).lower()


TOP_KEYS = [
    *("version", "name", "bindings", "layers", "extends", "timing", "filter", "latch", "safety")
]


@RELAXED
@given(st.fixed_dictionaries({}, optional=dict.fromkeys(TOP_KEYS, VALUES)))
def test_well_formed_documents_of_any_shape(document: dict) -> None:
    check(write_flow(document).encode())


USER_KEYS = ["version", "range", "filter", "timing", "mirror", "rotate_deg", "neutral", "slots"]


@RELAXED
@given(st.fixed_dictionaries({}, optional=dict.fromkeys([*USER_KEYS, "oops"], VALUES)))
def test_user_files_of_any_shape(document: dict) -> None:
    checked = check_user(write_flow(document).encode(), "p.yaml")
    assert (checked.whole is None) == bool(checked.faults)
    if checked.faults:
        assert LOCATED.match(checked.format()), checked.format()


@RELAXED
@given(st.dictionaries(st.sampled_from(["when", "do", "oops"]), VALUES))
def test_bindings_of_any_shape(binding: dict) -> None:
    check(f"version: 1\nname: x\nbindings: [{write_flow(binding)}]".encode())


@RELAXED
@given(VALUES)
def test_the_reader_agrees_with_a_second_one(value: object) -> None:
    """Our core schema resolution against ruamel's own safe loader, an independent route."""
    text = write_flow([value])
    root, faults = parse_document(text)
    assert not faults
    assert root is not None
    expected = YAML(typ="safe", pure=True).load(text)
    assert repr(root.value) == repr(expected)


@pytest.mark.parametrize("text", SHIPPED)
def test_a_second_reader_sees_the_same_profile(text: str) -> None:
    root, faults = parse_document(text)
    assert not faults
    assert root is not None
    assert root.value == YAML(typ="safe", pure=True).load(text)
