"""Edits touch one place; comments, order, quotes and layout of all else stay."""

import io

import pytest
from ruamel.yaml import YAML

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.yaml_document import parse_document
from neurotouch_hid.profile.editing.edited_file import compare
from neurotouch_hid.profile.editing.profile_text import ProfileText
from neurotouch_hid.profile.editing.yaml_values import format_value, parse_value
from neurotouch_hid.profile.reading.library import find_shipped_folder

SHIPPED = {
    name: (find_shipped_folder() / f"{name}.yaml").read_text(encoding="utf-8")
    for name in ("racing", "menu-switch")
}


def as_block(text: str) -> str:
    """The same profile by somebody who uses no brackets and indents by three."""
    yaml = YAML()
    yaml.indent(mapping=3, sequence=5, offset=3)
    yaml.width = 4096
    out = io.StringIO()
    yaml.dump(parse_document(text)[0].value, out)
    return out.getvalue()


LAYOUTS = {
    "as shipped": lambda text: text,
    "in blocks": as_block,
    "with carriage returns": lambda text: text.replace("\n", "\r\n"),
    "without a last line end": lambda text: text.rstrip("\n"),
}


def load(text):
    root, faults = parse_document(text)
    assert not faults
    return root.value


def list_scalars(value, keys=()):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from list_scalars(inner, (*keys, key))
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from list_scalars(inner, (*keys, i))
    else:
        yield keys


def put(document, keys, value):
    for key in keys[:-1]:
        document = document[key]
    document[keys[-1]] = value


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("name", SHIPPED)
def test_every_single_value_can_be_replaced_by_a_one_line_change(name, layout):
    text = LAYOUTS[layout](SHIPPED[name])
    for keys in list_scalars(load(text)):
        changed = ProfileText(text).replace(keys, "other-word").text
        expected = load(text)
        put(expected, keys, "other-word")
        assert load(changed) == expected
        assert [verb for verb, _, _ in compare(ProfileText(text), ProfileText(changed))] == [
            "removed",
            "added",
        ]
        assert changed.count("\n") == text.count("\n")
        assert changed.count("\r") == text.count("\r")


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("name", SHIPPED)
def test_what_is_inserted_and_removed_again_leaves_no_trace(name, layout):
    text = LAYOUTS[layout](SHIPPED[name])
    before = ProfileText(text)
    bindings = ("bindings",) if "bindings" in load(text) else ("layers", 0, "bindings")
    for keys in ((), (*bindings, 0, "do"), (*bindings, 0)):
        longer = before.insert(keys, "extra", [1.0, 2.0])
        assert len([1 for verb, _, _ in compare(before, longer) if verb == "added"]) == 1
        assert longer.remove((*keys, "extra")).text.rstrip("\r\n") == text.rstrip("\r\n")
    item = {"when": "pinch", "do": {"button": "y"}}
    longer = before.append(bindings, item)
    n = len(load(text)[bindings[0]]) if len(bindings) == 1 else None
    expected = load(text)
    target = expected
    for key in bindings:
        target = target[key]
    target.append(item)
    assert longer.document == expected
    if n is not None:
        assert longer.remove((*bindings, n)).text.rstrip("\r\n") == text.rstrip("\r\n")


@pytest.mark.parametrize("name", SHIPPED)
def test_every_key_and_item_can_be_removed(name):
    for layout in LAYOUTS.values():
        text = layout(SHIPPED[name])
        document = load(text)
        lists = [("bindings",)] if "bindings" in document else []
        lists += [("layers", i, "bindings") for i in range(len(document.get("layers", ())))]
        for keys in lists:
            expected = load(text)
            target = expected
            for key in keys:
                target = target[key]
            for i in reversed(range(1, len(target))):
                del target[i]
                text = ProfileText(text).remove((*keys, i)).text
                assert load(text) == expected


def test_quotes_and_comments_stay():
    text = "a: 'one'  # first\nb: \"two\"\n# between\nc: [1, 2]  # last\n"
    assert ProfileText(text).replace(("a",), "it's").text == text.replace("'one'", "'it''s'")
    assert ProfileText(text).replace(("b",), "x").text == text.replace('"two"', '"x"')
    assert ProfileText(text).replace(("c", 1), 3).text == text.replace("[1, 2]", "[1, 3]")
    assert ProfileText(text).remove(("b",)).text == text.replace('b: "two"\n', "")
    assert ProfileText(text).insert((), "d", 4, order=("a", "d")).text == text.replace(
        "first\n", "first\nd: 4\n"
    )


def test_a_comment_goes_only_with_the_one_item_it_stands_above():
    text = "list:\n  # for both\n  - a: 1\n  - a: 2\n\n  # for one\n  - a: 3\n"
    assert "for both" in ProfileText(text).remove(("list", 0)).text
    assert "for one" not in ProfileText(text).remove(("list", 2)).text
    assert "for both" in ProfileText(text).remove(("list", 1)).text


def test_a_block_becomes_a_bracket_where_it_is_replaced():
    text = "do:\n  stick: left\n  gain: 2\nend: 1\n"
    assert ProfileText(text).replace(("do",), {"button": "a"}).text == "do: {button: a}\nend: 1\n"


def test_the_first_key_of_an_item_can_go():
    text = "list:\n- when: push\n  do: {button: a}\n"
    assert ProfileText(text).remove(("list", 0, "when")).text == "list:\n- do: {button: a}\n"


def test_what_would_be_empty_goes_too():
    text = "a: {b: {c: 1}}\nd: 2\n"
    assert ProfileText(text).remove(("a", "b", "c")).text == "d: 2\n"


@pytest.mark.parametrize("keys", [("x",), ("list", 5), ("list", 0, "a", "b"), ()])
def test_a_place_that_is_not_there_is_refused(keys):
    with pytest.raises(ProfileError):
        ProfileText("list:\n  - a: 1\n").replace(keys, 1)


WORDS = ("y", "on", "-", "+", "a: b", "{", "1", "1e5", "true", "it's", 'say "x"', "é\t\x07", " a ")
ODD = ("#x", "ctrl+c", "a b", ".5", "~", "null", "--", "\\", "page_up", "", "0x1f", "\U0001f600")
PLAIN = (0, -4, 0.25, 1e-9, True, False, [1.0, [2, "y"]], {"a b": {"on": "off"}}, [], {})


@pytest.mark.parametrize("value", [*WORDS, *ODD, *PLAIN])
def test_a_value_is_read_as_it_was_written(value):
    for quote in ("'", '"'):
        assert load(f"key: {format_value(value, quote)}")["key"] == value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.40", 0.4),
        ("-", "-"),
        ("+", "+"),
        ("#", "#"),
        ("a", "a"),
        ("yes", "yes"),
        ("true", True),
        ("-0.5", -0.5),
        ('"7"', "7"),
        ("[1, 6]", [1, 6]),
        ("{expo: 0.3}", {"expo": 0.3}),
    ],
)
def test_a_value_is_what_people_mean(text, value):
    assert parse_value(text) == value


@pytest.mark.parametrize("text", ["", "  ", "[1, 6", "{a: }", "&a 1", "!!python/object x", "*a"])
def test_other_values_are_refused(text):
    with pytest.raises(ProfileError):
        parse_value(text)
