"""Wrong profiles: every mistake at its place, in plain words, all at once."""

import os
import re
import textwrap

import pytest

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES
from neurotouch_hid.profile.editing.edited_file import read_text
from neurotouch_hid.profile.reading.load import load_profile, parse_profile

CODE = re.compile(r": error\[NT1\d\d\]: ")
HEAD = "version: 1\nname: x\nbindings:\n"
"""Three lines that are right; the first binding begins in line 4."""


def complain(text: str | bytes) -> str:
    content = text.encode() if isinstance(text, str) else text
    with pytest.raises(ProfileError) as caught:
        parse_profile(content, "p.yaml")
    return caught.value.message


def headers(text: str | bytes) -> list[str]:
    lines = [line for line in complain(text).splitlines() if line.startswith("p.yaml:")]
    assert all(CODE.search(line) for line in lines[:20])
    return [CODE.sub(": error: ", line) for line in lines]


def binding(when: str = "push", do: str = "{button: a}") -> str:
    return f"{HEAD}  - when: {when}\n    do: {do}\n"


FULL_TEXTS = [
    (
        binding(when="zom"),
        """\
        p.yaml:4:11: error[NT112]: bindings[0].when: 'zom' is not one of: push, pinch, zoom, \
twist_cw, twist_ccw, twist, scale, any
             4 |   - when: zom
               |           ^^^ did you mean 'zoom'?""",
    ),
    (
        binding(do="{stick: left, range_mm: [1, 25]}"),
        """\
        p.yaml:5:37: error[NT114]: bindings[0].do.range_mm[1]: 25 is too large, at most 18 mm
             5 |     do: {stick: left, range_mm: [1, 25]}
               |                                     ^^""",
    ),
    (
        "versionx: 1\nname: x\nbindings: []\n",
        """\
        p.yaml:1:1: error[NT110]: versionx: unknown key; known here: version, name, description, \
extends, timing, filter, latch, bindings, layers, safety
             1 | versionx: 1
               | ^^^^^^^^ did you mean 'version'?
        p.yaml:3:1: error[NT116]: bindings: needs at least one entry
             3 | bindings: []
               | ^^^^^^^^""",
    ),
    (
        binding(do="{stik: left}"),
        """\
        p.yaml:5:10: error[NT117]: bindings[0].do: needs exactly one of: stick, axis, \
trigger, button, dpad, key, mouse, layer, command
             5 |     do: {stik: left}
               |          ^^^^ did you mean 'stick'?""",
    ),
    (
        binding(do="{stick: left, axis: left_x}"),
        """\
        p.yaml:5:23: error[NT117]: bindings[0].do: needs exactly one of: stick, axis, \
trigger, button, dpad, key, mouse, layer, command
             5 |     do: {stick: left, axis: left_x}
               |                       ^^^^ beside 'stick'""",
    ),
    (
        binding(do="{axis: left_y, sign: - , deadzone: 0.1}"),
        """\
        p.yaml:5:30: error[NT102]: bindings[0].do.sign: a '-' begins a list, which cannot be here
             5 |     do: {axis: left_y, sign: - , deadzone: 0.1}
               |                              ^ write "-" for a minus, or close a "[" before it""",
    ),
]


@pytest.mark.parametrize(("text", "expected"), FULL_TEXTS)
def test_the_whole_message(text: str, expected: str) -> None:
    assert complain(text) == textwrap.dedent(expected)


GESTURES = "push, pinch, zoom, twist_cw, twist_ccw, twist, scale, any"
BUTTONS = "a, b, x, y, lb, rb, back, start, guide, ls, rs"
ONE_TARGET = "needs exactly one of: stick, axis, trigger, button, dpad, key, mouse, layer, command"

# § stands before each mistake; the sentences follow in that order.
MISTAKES = [
    ("§", ["the file is empty"]),
    ("§# only a comment\n", ["the file is empty"]),
    ("§- 1\n", ["needs keys with values, not a list"]),
    ("§hello", ["needs keys with values, not 'hello'"]),
    ("§§version: 1\n", ["the key 'bindings' is missing", "the key 'name' is missing"]),
    (
        "version: §2\nname: X!\nbindings: 3\n",
        ["version: this program reads version 1 of the format"],
    ),
    (
        "version: 1\nname: §X!\nbindings: §3\n",
        [
            "name: needs 1 to 64 small letters, digits, _ or -, and no - in front",
            "bindings: needs a list, not 3",
        ],
    ),
    (
        "version: §true\nname: §3\nbindings: [§3, §null]\n",
        [
            "version: needs a whole number, not true",
            "name: needs a word, not 3",
            "bindings[0]: needs keys with values, not 3",
            "bindings[1]: a value is missing here",
        ],
    ),
    (
        "version: §1.0\nname: x\n§bindings: []",
        ["version: needs a whole number, not 1.0", "bindings: needs at least one entry"],
    ),
    (f"description: §{'long' * 200}\n{binding()}", ["description: is longer than 500 characters"]),
    (binding(when="§none"), [f"bindings[0].when: 'none' is not one of: {GESTURES}"]),
    (HEAD + "  - §when: \n    do: {button: a}\n", ["bindings[0].when: a value is missing here"]),
    (
        binding(when="{gesture: push, direction: §lft}"),
        [
            "bindings[0].when.direction: 'lft' is not one of: left, right, up, down, "
            "up_left, up_right, down_left, down_right"
        ],
    ),
    (
        binding(when="{gesture: pinch, direction: §up}"),
        ["bindings[0].when.direction: only a push has a direction, a pinch has none"],
    ),
    (
        binding(when="{gesture: pinch, contacts: §4}"),
        ["bindings[0].when.contacts: 4 is too large, at most 3"],
    ),
    (
        binding(when="{gesture: pinch, contacts: §2.0}"),
        ["bindings[0].when.contacts: needs a whole number, not 2.0"],
    ),
    (
        binding(when="{gesture: pinch, on_mm: §0.5}"),
        ["bindings[0].when.on_mm: 0.5 is too small, at least 1 mm"],
    ),
    (
        binding(when="{gesture: pinch, on_mm: 3, off_mm: §3}"),
        [
            "bindings[0].when.off_mm: off_mm (3 mm) must be below on_mm (3 mm), "
            "or the output would flicker"
        ],
    ),
    (
        binding(when="{gesture: pinch, off_mm: §2.5}"),
        [
            "bindings[0].when.off_mm: off_mm (2.5 mm) must be below on_mm (2.5 mm), "
            "or the output would flicker"
        ],
    ),
    (
        binding(when="{gesture: pinch, on_mm: §.nan}"),
        ["bindings[0].when.on_mm: needs a finite number, not nan"],
    ),
    (
        binding(when="{gesture: pinch, on_mm: §1e400}"),
        ["bindings[0].when.on_mm: needs a finite number, not inf"],
    ),
    (
        binding(when="{§gestur: pinch}"),
        [
            "bindings[0].when.gestur: unknown key; "
            "known here: gesture, direction, sectors, zone, contacts, with_button, level, phase, "
            "min_speed_mm_s, on_mm, off_mm, press, hold_ms, accept_ms, ignore_repeat_ms, "
            "trigger, release"
        ],
    ),
    (
        HEAD + "  - §when: [push]\n    do: {button: a}\n",
        [f"bindings[0].when: a list is not one of: {GESTURES}"],
    ),
    (HEAD + "  - when: push\n    §do: {}\n", [f"bindings[0].do: {ONE_TARGET}"]),
    (binding(do="§a"), [f"bindings[0].do: {ONE_TARGET}"]),
    (binding(do="{button: §q}"), [f"bindings[0].do.button: 'q' is not one of: {BUTTONS}"]),
    (binding(do="{button: §on}"), [f"bindings[0].do.button: 'on' is not one of: {BUTTONS}"]),
    (
        binding(do="{button: a, §deadzone: 0.1}"),
        ["bindings[0].do.deadzone: unknown key; known here: mode, repeat, every_ms, max_s, button"],
    ),
    (
        binding(do="{stick: left, invert_y: §yes}"),
        ["bindings[0].do.invert_y: needs true or false, not 'yes'"],
    ),
    (
        binding(do="{stick: left, deadzone: §fast, §range_mm: [2]}"),
        [
            "bindings[0].do.deadzone: needs a number, not 'fast'",
            "bindings[0].do.range_mm: needs two numbers, [rest, full]",
        ],
    ),
    (
        binding(do="{stick: left, §range_mm: [1, 2, 3]}"),
        ["bindings[0].do.range_mm: has more than 2 entries"],
    ),
    (
        binding(do="{stick: left, range_mm: §3}"),
        ["bindings[0].do.range_mm: needs a list of two numbers, [rest, full], not 3"],
    ),
    (
        binding(do="{stick: left, §range_mm: [4, 4.2]}"),
        [
            "bindings[0].do.range_mm: full must be at least 0.5 mm above rest, "
            "or the output would jump"
        ],
    ),
    (
        binding(do="{stick: left, curve: §cubic}"),
        ["bindings[0].do.curve: needs exactly one of: linear, expo, power, points"],
    ),
    (
        binding(do="{stick: left, curve: {expo: 0.1, §power: 2}}"),
        ["bindings[0].do.curve: needs exactly one of: linear, expo, power, points"],
    ),
    (
        binding(do="{stick: left, curve: {expo: §2}}"),
        ["bindings[0].do.curve.expo: 2 is too large, at most 1"],
    ),
    (
        binding(when="pinch", do="{stick: §right}"),
        [
            "bindings[0].do.stick: a whole stick follows the direction of a push; "
            "a pinch moves one axis, 'axis: right_x'"
        ],
    ),
    (
        HEAD + "  - when: push\n    do: {button: a}\n    §do: {button: b}\n",
        ["bindings[0].do: this key is already in line 5, column 5"],
    ),
    (
        "§<stick>: 1\nversion: 1\nname: x\nbindings:\n  - when: push\n    do: {button: a}\n",
        [
            "<stick>: unknown key; known here: version, name, description, extends, timing, "
            "filter, latch, bindings, layers, safety"
        ],
    ),
]


@pytest.mark.parametrize(("marked", "sentences"), MISTAKES)
def test_every_mistake_once_and_in_its_place(marked: str, sentences: list[str]) -> None:
    places = [
        (number, column - shift)
        for number, line in enumerate(marked.split("\n"), 1)
        for shift, column in enumerate((i for i, c in enumerate(line, 1) if c == "§"))
    ]
    expected = [
        f"p.yaml:{line}:{column}: error: {sentence}"
        for (line, column), sentence in zip(places, sentences, strict=True)
    ]
    assert headers(marked.replace("§", "")) == expected


HOSTILE = [
    (
        "a: &x [1]\nb: *x\n",
        "1:4: error: a: anchors (&) and aliases (*) are not allowed",
    ),
    ("a: *x\n", "1:4: error: a: anchors (&) and aliases (*) are not allowed"),
    ("a: !!python/object:os.system {}\n", "1:4: error: a: tags (!) are not allowed"),
    ("a: !!int 3\n", "1:4: error: a: tags (!) are not allowed"),
    ("a: 1\n---\nb: 2\n", "2:1: error: a second document begins here, and only one is allowed"),
    ("%YAML 1.1\n---\na: 1\n", "2:1: error: directives (%) are not allowed"),
    ("? [a]\n: 1\n", "1:3: error: a key must be a word"),
    ("a: " + "[" * 30_000, "1:19: error: a" + "[0]" * 15 + ": more than 16 levels are not allowed"),
    ("[" + "1," * 6_000 + "]", "1:10000: error: more than 5000 values are not allowed"),
    ("a: " + "9" * 65, "1:4: error: a: a number has at most 64 characters"),
    ('a: "\\U99999999"\n', "1:1: error: a: this escape is no character"),
    ("name: x\nb: \x1b[31m\n", "2:4: error: the character U+001B is not allowed in YAML"),
    ('a: "\\ud800+a"\n', "1:4: error: a: this escape is half a character"),
    ('"\\udfff": 1\n', "1:1: error: this escape is half a character"),
    ("a:\n\tb: 1\n", "2:1: error: a: a tab cannot indent or begin a value"),
    ("a: {b: 1\n", "2:1: error: a: a '{' is opened and not closed before here"),
    (b"a: 1\nb: \xff\n", "2:4: error: byte 0xff is not UTF-8 text"),
]


@pytest.mark.parametrize(("text", "expected"), HOSTILE)
def test_hostile_text_is_refused_before_anything_is_built(text: str | bytes, expected: str) -> None:
    (header,) = headers(text)
    assert header.startswith(f"p.yaml:{expected}")


def test_the_size_is_looked_at_first(tmp_path) -> None:
    message = complain(b"&" * (MAX_SETTINGS_BYTES + 1))
    assert message.startswith("p.yaml:1:1: error[NT101]: the file is larger than 64 kB\n")
    comment = b"#" * (MAX_SETTINGS_BYTES - len(binding()) - 1) + b"\n"
    parse_profile(comment + binding().encode(), "p.yaml")
    (tmp_path / "large.yaml").write_bytes(b" " * (1 << 20))
    for read in (load_profile, read_text):
        with pytest.raises(ProfileError, match="larger than 64 kB") as caught:
            read(tmp_path / "large.yaml")
        assert caught.value.hint.startswith("Make it smaller")


def test_many_mistakes_are_counted_not_poured_out() -> None:
    message = complain(HEAD + "  - 1\n" * 100)
    assert message.count("error[NT113]:") == 20
    assert message.endswith("p.yaml: 80 more")


def test_a_long_line_is_cut_around_the_mistake() -> None:
    text = binding(do="{stick: left, " + " " * 300 + "deadzone: fast}")
    *_, line, carets = complain(text).splitlines()
    assert len(line) < 120
    assert line[carets.index("^") : carets.rindex("^") + 1] == "fast"


def test_a_line_that_fits_is_shown_whole() -> None:
    text = binding(do="{stick: left, range_mm: [1, 8], curve: linear, deadzone: fast}")
    assert "     5 | " + text.splitlines()[4] in complain(text).splitlines()


def test_windows_line_ends_and_a_byte_order_mark_are_fine() -> None:
    text = "\ufeff" + binding().replace("\n", "\r\n")
    assert parse_profile(text.encode(), "p.yaml").name == "x"
    assert headers("\ufeffversionx: 1\n" + binding())[0].startswith("p.yaml:1:1: error: versionx: ")
    assert headers("\ufeff" + binding(do="a").replace("\n", "\r\n")) == [
        f"p.yaml:5:9: error: bindings[0].do: {ONE_TARGET}"
    ]


def test_words_stay_words() -> None:
    profile = parse_profile((binding() + "description: off\n").encode(), "p.yaml")
    assert profile.description == "off"
    profile = parse_profile((binding() + "description: 'true'\n").encode(), "p.yaml")
    assert profile.description == "true"


def test_paths_that_cannot_be_read(tmp_path) -> None:
    with pytest.raises(ProfileError, match=r"does not exist\.$"):
        load_profile(tmp_path / "gone.yaml")
    with pytest.raises(ProfileError, match=r"it is a folder, not a file\.$"):
        load_profile(tmp_path)
    os.mkfifo(tmp_path / "pipe.yaml")
    with pytest.raises(ProfileError, match=r"it is a pipe, not a file\.$"):
        load_profile(tmp_path / "pipe.yaml")
    with pytest.raises(ProfileError, match=r"cannot be read"):
        load_profile("a\0b.yaml")
    (tmp_path / "locked.yaml").write_text(binding())
    (tmp_path / "locked.yaml").chmod(0)
    if os.geteuid() != 0:
        with pytest.raises(ProfileError, match=r"cannot be read: Permission denied\.$"):
            load_profile(tmp_path / "locked.yaml")


def test_the_message_names_the_file_as_given(tmp_path, monkeypatch) -> None:
    (tmp_path / "mine.yaml").write_text(binding(when="zom"))
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ProfileError, match=r"^mine\.yaml:4:11: error\[NT112\]: ") as caught:
        load_profile("mine.yaml")
    assert caught.value.exit_code == 6
