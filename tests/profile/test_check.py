"""Faults that need the whole profile, warnings, codes, keys, and profiles built on others."""

import re
from pathlib import Path

import pytest

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.messages import Button
from neurotouch_hid.profile import Mapping, check_content, check_profile, explain, load_profile
from neurotouch_hid.profile.diagnostics.codes import CODES
from neurotouch_hid.profile.diagnostics.description import describe_target
from neurotouch_hid.profile.schema.keyboard_keys import KEYS, parse_chord
from tests.profile.stage import RAW, run

HEAD = "version: 1\nname: x\n"


def codes(text: str) -> list[str]:
    return [fault.code for fault in check_content(text.encode(), "p.yaml").faults]


def one(binding: str, more: str = "") -> str:
    return f"{HEAD}{more}bindings:\n  - {{{binding}}}\n"


def several(*bindings: str) -> str:
    return HEAD + "bindings:\n" + "".join(f"  - {{{binding}}}\n" for binding in bindings)


PINCH = "when: {gesture: pinch, %s}, do: {button: a}"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (one(PINCH % "contacts: 2"), ["NT201"]),
        (one(PINCH % "contacts: 2, on_mm: 7"), []),
        (one(PINCH % "on_mm: 3, off_mm: 2.5"), ["NT202"]),
        (one(PINCH % "on_mm: 2"), ["NT210", "NT202"]),
        (several(PINCH % "press: tap", PINCH % "press: double"), ["NT203"]),
        (several(PINCH % "press: tap, phase: hold", PINCH % "press: double"), []),
        (several(PINCH % "press: tap", PINCH % "press: tap"), ["NT204"]),
        (one("when: {gesture: zoom, on_mm: 7.5}, do: {button: a}"), ["NT204"]),
        (one(PINCH % "press: hold, hold_ms: 6000"), ["NT205"]),
        (
            HEAD + "layers:\n  - {name: a, bindings: [{when: pinch, do: {layer: b, mode: hold}}]}\n"
            "  - {name: b, bindings: [{when: zoom, do: {button: a}}]}\n",
            ["NT206"],
        ),
        (
            several(PINCH % "level: soft", "when: {gesture: pinch, level: hard, on_mm: 5}, "
                    "do: {button: b}"),
            ["NT207"],
        ),
        (several(PINCH % "press: tap", "when: pinch, do: {button: b}"), ["NT208"]),
        (several(PINCH % "press: tap, on_mm: 5", "when: pinch, do: {button: b}"), ["NT208"]),
        (several(PINCH % "press: tap", PINCH % "on_mm: 10"), []),  # a light tap presses nothing
        (
            f"{HEAD}layers:\n  - {{name: a, bindings: [{{when: pinch, do: {{button: a}}}}]}}\n"
            "  - {name: b, bindings: [{when: zoom, do: {layer: a}}]}\n",
            ["NT209"],
        ),
        (one(PINCH % "off_mm: 1", "safety: {panic: {gesture: zoom}}\n"), ["NT211"]),
        (several("when: push, do: {stick: left}", "when: push, do: {button: a}"), []),
    ],
)  # fmt: skip
def test_warnings(text: str, expected: list[str]) -> None:
    checked = check_content(text.encode(), "p.yaml")
    assert [fault.code for fault in checked.faults] == expected, checked.format()
    assert checked.whole is not None, "a warning keeps nothing from being loaded"
    assert all(fault.severity == "warning" for fault in checked.faults)


@pytest.mark.parametrize(
    ("text", "header"),
    [
        (
            one("when: pinch, do: {layer: menu}"),
            "4:31: error[NT133]: bindings[0].do.layer: there is no layer 'menu'; layers: base",
        ),
        (
            f"{HEAD}bindings: [{{when: pinch, do: {{layer: menu}}}}]\n"
            "layers: [{name: menu, below: empty, bindings: [{when: zoom, do: {button: a}}]}]\n",
            "4:11: error[NT134]: layers[0]: nothing leads back from the layer 'menu'",
        ),
        (
            f"{HEAD}layers:\n"
            "  - {name: a, bindings: [{when: zoom, do: {button: a}}]}\n"
            "  - {name: a, bindings: [{when: zoom, do: {button: a}}]}\n",
            "5:12: error[NT135]: layers[1].name: there is already a layer 'a'",
        ),
        (
            one("when: pinch, do: {key: ctrl+entr}"),
            "4:29: error[NT127]: bindings[0].do.key: 'entr' is not the name of a key",
        ),
        (
            one("when: pinch, do: {trigger: left, mode: toggle}"),
            "4:45: error[NT125]: bindings[0].do.mode: only what is pressed has modes: add "
            "'value: 1.0' to press this to its end",
        ),
        (
            one("when: {gesture: pinch, press: tap}, do: {trigger: left}"),
            "4:36: error[NT125]: bindings[0].when.press: what follows a gesture has no 'press', "
            "only what is pressed",
        ),
        (
            one("when: pinch, do: {mouse: motion}"),
            "4:31: error[NT124]: bindings[0].do.mouse: a whole pointer follows the direction of a "
            "push; a pinch moves one axis, the wheel",
        ),
        (
            one("when: push, do: {stick: left, curve: {points: [[0.5, 0.5], [0.4, 1]]}}"),
            "4:44: error[NT114]: bindings[0].do.curve.points: each point must be right of the one "
            "before by 0.01, and not below it",
        ),
        (
            one("when: {sequence: [push]}, do: {button: a}"),
            "4:13: error[NT116]: bindings[0].when.sequence: needs at least 2 entries",
        ),
        (one("when: pinch, do: {button: a}", "extends: [../x]\n"),
         "3:11: error[NT118]: extends[0]: needs 1 to 64 small letters, digits, _ or -, "
         "and no - in front"),
        (one("when: pinch, do: {button: a}", "extends: [nobody]\n"),
         "3:11: error[NT130]: extends[0]: no profile is called 'nobody'"),
        (one("when: pinch, do: {button: a}", "timing: fast\n"),
         "3:9: error[NT112]: timing: 'fast' is not one of: game, steady, slow"),
    ],
)  # fmt: skip
def test_errors(text: str, header: str) -> None:
    first = check_content(text.encode(), "p.yaml").format().splitlines()[0]
    assert first == f"p.yaml:{header}"


@pytest.mark.parametrize(
    ("binding", "more", "shown"),
    [
        ("when: pinch, do: {key: 3}", "", 'needs a word, not 3\n ^ write "3"'),
        (
            "when: pinch, do: {mouse: whel}",
            "",
            "'whel' is not one of: left, right, middle, back, forward, motion, wheel\n"
            " ^^^^ did you mean 'wheel'?",
        ),
        ("when: pinch, do: {key: ctl+c}", "", "not the name of a key\n ^^^^^ did you mean 'ctrl'?"),
        (
            "when: pinch, do: {key: ctrl++}",
            "",
            'of a key\n ^^^^^^ the key itself is called "equal"',
        ),
        (
            "when: pinch, do: {button: a}",
            "extends: flight\n",
            "needs a list, not 'flight'\n ^^^^^^ write [flight]",
        ),
    ],
)
def test_hints(binding: str, more: str, shown: str) -> None:
    header, _, carets = check_content(one(binding, more).encode(), "p.yaml").format().split("\n")
    sentence, hint = shown.split("\n")
    assert header.endswith(sentence)
    assert carets.endswith(hint)


def test_every_code_in_the_program_is_explained_and_every_explained_code_is_used() -> None:
    folder = Path(explain.__code__.co_filename).parents[2]
    used = set()
    for path in folder.rglob("*.py"):
        if path.name != "codes.py":
            used |= set(re.findall(r"\bNT\d\d\d\b", path.read_text(encoding="utf-8")))
    assert used == set(CODES)


def test_codes_are_explained() -> None:
    assert explain("nt203").title == "a double tap that delays the tap"
    with pytest.raises(ProfileError, match="No fault has the code 'NT9'"):
        explain("NT9")


def test_keys_have_kernel_names() -> None:
    assert parse_chord("ctrl+shift+f5") == ("KEY_LEFTCTRL", "KEY_LEFTSHIFT", "KEY_F5")
    ecodes = pytest.importorskip("evdev").ecodes.ecodes
    assert not [name for name in KEYS.values() if name not in ecodes]
    assert len(set(KEYS.values())) == len(KEYS)


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    folder = tmp_path / "neurotouch" / "profiles"
    folder.mkdir(parents=True)
    return folder


def write(folder: Path, name: str, text: str) -> None:
    (folder / f"{name}.yaml").write_text(f"version: 1\nname: {name}\n{text}")


def test_a_profile_built_on_another_says_only_what_is_different(folder: Path) -> None:
    write(folder, "mine", "extends: [flight]\nbindings:\n  - {when: pinch, do: {button: y}}\n")
    whole = load_profile("mine")
    assert whole.name == "mine"
    assert [layer.name for layer in whole.all_layers] == ["fly", "cockpit"]
    assert whole.safety.pause is not None
    states = run(Mapping(whole, RAW), "pinch 5mm; rest 50ms; push left 8mm")
    assert frozenset({Button.Y}) in [state.buttons for state in states]
    assert any(state.axes for state in states)
    assert not any("left_trigger" in state.axes for state in states)
    assert check_profile("mine").written != whole


@pytest.mark.parametrize(
    ("when", "kept"),
    [
        ("pinch", []),
        ("{gesture: pinch, on_mm: 4}", ["trigger left"]),
        ("{gesture: pinch, on_mm: 12}", ["trigger left", "button a"]),
        ("{gesture: pinch, press: tap}", ["trigger left", "button a"]),
        ("{gesture: pinch, contacts: 2, on_mm: 8}", ["trigger left", "button a"]),
        ("any", []),
        ("zoom", ["trigger left", "button a"]),
    ],
)
def test_what_covers_what(folder: Path, when: str, kept: list[str]) -> None:
    write(folder, "mine", f"extends: [default]\nbindings:\n  - {{when: {when}, do: {{key: a}}}}\n")
    (layer,) = load_profile("mine").all_layers
    pinches = [binding for binding in layer.bindings if binding.condition.gesture == "pinch"]
    words = [describe_target(binding.do) for binding in pinches]
    assert [word for word in words if word != "key a"] == kept


def test_nothing_but_extends_is_enough_and_the_first_base_wins(folder: Path) -> None:
    write(folder, "a", "bindings:\n  - {when: pinch, do: {button: a}}\n")
    write(folder, "b", "timing: slow\nbindings:\n  - {when: pinch, do: {button: b}}\n"
          "  - {when: zoom, do: {button: x}}\n")  # fmt: skip
    write(folder, "c", "extends: [a, b]\n")
    whole = load_profile("c")
    (layer,) = whole.all_layers
    assert [binding.do.button.value for binding in layer.bindings] == ["a", "x"]
    assert whole.timing == "slow"


def test_circles_wrong_bases_and_long_ways_are_refused(folder: Path) -> None:
    for name, base in (("a", "b"), ("b", "c"), ("c", "a")):
        write(folder, name, f"extends: [{base}]\n")
    with pytest.raises(ProfileError, match=r"NT132.*'b' has errors"):
        load_profile("a")
    write(folder, "self", "extends: [self]\n")
    with pytest.raises(ProfileError, match=r"NT131.*is built on this profile itself"):
        load_profile("self")
    write(folder, "wrong", "extends: [broken]\n")
    write(folder, "broken", "bindings: 3\n")
    with pytest.raises(ProfileError, match="NT132"):
        load_profile("wrong")
    for i in range(9):
        write(folder, f"l{i}", f"extends: [l{i + 1}]\n")
    write(folder, "l9", "bindings:\n  - {when: pinch, do: {button: a}}\n")
    with pytest.raises(ProfileError):
        load_profile("l0")
    assert load_profile("l7").all_layers


def test_too_much_of_everything_is_refused(folder: Path) -> None:
    def many(press: str) -> str:
        when = "{{gesture: pinch, hold_ms: {}, press: {}}}"
        lines = (f"  - {{when: {when.format(i, press)}, do: {{key: a}}}}\n" for i in range(200))
        return "bindings:\n" + "".join(lines)

    write(folder, "a", many("long"))
    write(folder, "b", "extends: [a]\n" + many("hold"))
    with pytest.raises(ProfileError, match="NT136"):
        load_profile("b")


@pytest.mark.parametrize(
    "evil", [r"\e[2K\e]0;owned\a", r"\u202Ehidden", r"\x9B8m", r"\u2066", r"\U000E0041", r"\0"]
)
def test_a_description_hides_nothing_from_who_reads_it(evil):
    text = f'{HEAD}description: "Fine.{evil}"\n{one(PINCH % "on_mm: 5").removeprefix(HEAD)}'
    (fault,) = check_content(text.encode(), "p.yaml").faults
    assert fault.code == "NT120"
    assert fault.path == "description"
    assert "U+" in fault.sentence
    assert fault.sentence.isprintable()


@pytest.mark.parametrize("said", ["Zum Üben 🎮, for 한국", "می‌خواهم", r"two\nlines", "क्‍ष"])
def test_a_description_is_in_any_language(said):
    text = f'{HEAD}description: "{said}"\n{one(PINCH % "on_mm: 5").removeprefix(HEAD)}'
    assert codes(text) == []


def test_a_binding_that_acts_first_is_named_in_words_with_the_later_one_s_line() -> None:
    text = several(PINCH % "press: tap", "when: pinch, do: {button: b}")
    (fault,) = check_content(text.encode(), "p.yaml").faults
    assert fault.sentence == (
        "'pinch -> button b' acts first, each time that you make 'pinch tap -> button a' (line 4)"
    )
    assert text.splitlines()[3].lstrip().startswith("- {when: {gesture: pinch, press: tap}")


@pytest.mark.parametrize(
    ("version", "fix"), [(9, "update the program"), (0, "neurotouch profile upgrade FILE")]
)
def test_of_another_version_only_that_is_told_with_its_fix(version: int, fix: str) -> None:
    text = f"version: {version}\nbindings: []\nspeed: 3\n"
    (fault,) = check_content(text.encode(), "p.yaml").faults
    assert (fault.code, fault.hint) == ("NT119", fix)
