"""Texts of profiles: each is a profile, or has faults that can be shown; edits end in a text."""

import random
from typing import Final

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.profile import Profile, UserSettings, check_content
from neurotouch_hid.profile.diagnostics import CODES
from neurotouch_hid.profile.editing import (
    ProfileText,
    compare,
    name_bindings,
    parse_do,
    parse_when,
    rebind,
    remove_binding,
    set_value,
    summarize,
)
from neurotouch_hid.profile.reading import find_shipped_folder
from tests.fuzz.json_values import VALUES

_SHIPPED: Final = [
    path.read_text(encoding="utf-8") for path in sorted(find_shipped_folder().glob("*.yaml"))
]
_TOKENS: Final = [
    *"{}[](),:-?&*!|>%@`#'\"\n\t \\~<=.+/",
    *("\n  ", "\n    ", ": ", "- ", "? ", "---\n", "...\n", "<<: ", "&a ", "*a", "!!int ", "\r\n"),
    *("0", "-1", "1e308", "9" * 19, "9" * 400, "0x1F", "1_0", ".nan", "-.inf", "null", "٣"),
    *("\\U99999999", '"\\ud800"', r'"\e[2K"', r'"\u202e"', "\x00", "\x1b", "\u2028", "\x85", "🙂"),
    *("description: ", "push", "pinch", "layer", "button", "on_mm", "extends: [mine]", "[" * 60),
]
_WHENS: Final = ("pinch", "push left", "push left tap", "zoom hold", "twist cw double", "nonsense")
_DOS: Final = ("button a", "stick left", "toggle button b", "key space", "layer menu", "nonsense")


def make(rng: random.Random) -> bytes:
    """Returns a shipped profile with a few slips, as bytes."""
    text = rng.choice(_SHIPPED)
    for _ in range(rng.choice((0, 1, 1, 2, 5))):
        at, cut = rng.randint(0, len(text)), rng.choice((0, 0, 1, 3, 12, 200))
        other = rng.choice(_SHIPPED)
        from_ = rng.randint(0, len(other))
        new = rng.choice((*_TOKENS, other[from_ : from_ + 80]))
        text = text[:at] + new + text[at + cut :]
    content = bytearray(text.encode("utf-8", "surrogatepass"))
    if content and rng.random() < 0.1:
        content[rng.randrange(len(content))] = rng.randrange(256)
    return bytes(content)


def check(case: bytes) -> None:
    """Reads it; if it is a profile, shows and edits it.

    Raises:
        AssertionError: a fault has no place or cannot be shown, or an edit has broken it.
    """
    checked = check_content(case, "p.yaml")
    n_lines = checked.text.count("\n") + checked.text.count("\r") + 2
    for fault in checked.faults:
        assert fault.code in CODES, fault
        assert fault.mark.line <= n_lines + checked.text.count("\x85"), fault
        assert (fault.path + fault.sentence + fault.hint).isprintable(), fault
    _require_printable(checked.format())
    if not isinstance(checked.written, Profile):
        assert any(fault.severity == "error" for fault in checked.faults)
        return
    lines = list(summarize(checked.written, UserSettings()))
    assert all(line.isprintable() or "\u200d" in line or "\u200c" in line for line in lines)
    _edit(checked.text, checked.written, random.Random(case))


def _edit(text: str, profile: Profile, rng: random.Random) -> None:
    """Changes it three times; each ends in a text that can be checked, or in one refusal."""
    before = ProfileText(text)
    for _ in range(3):
        documents = [each.model_dump(exclude_unset=True) for each in profile.bindings or ()]
        key = rng.choice([*name_bindings(documents), "pinch", "layers.menu.zoom", "x[0]", "\x1b"])
        part = rng.choice(("on_mm", "off_mm", "range_mm", "curve.expo", "do", "nothing", "curve"))
        try:
            match rng.randrange(3):
                case 0:
                    changed = set_value(
                        before, f"{key}.{part}", rng.choice([*VALUES, 3.5, [1.0, 5]])
                    )
                case 1:
                    changed = remove_binding(before, key)
                case _:
                    when, do = parse_when(rng.choice(_WHENS)), parse_do(rng.choice(_DOS))
                    changed = rebind(before, when, do, None, instead=rng.choice((None, key)))
        except ProfileError as error:
            _require_printable(error.message)
            continue
        list(compare(before, changed))
        again = check_content(changed.text.encode(), "p.yaml")  # as every save does; it may refuse
        _require_printable(again.format())


def _require_printable(text: str) -> None:
    assert all(line.isprintable() for line in text.split("\n")), text
