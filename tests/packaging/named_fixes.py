"""Reads which calls an answer names as its fix or as the next step, as a person understands it."""

import difflib
import re
import shlex
from collections.abc import Iterable, Iterator, Mapping

_SENTENCE = re.compile(
    r"^(?:Fix|Next|Start it|Try|To try it)\b|\b(?:Did you mean|Next: |Start it: |Fix: )"
)
_CALL = re.compile(r"(?<![\w/.-])neurotouch (?:[a-z-](?:'[^']*'|[^'.,;()\n]|[.,](?=\S))*)")
_END = re.compile(r"\s+(?:or|and|to|shows|lists|says|as)\b(?!-)|\s{2,}|:\s")
_MEANT = re.compile(r"Did you mean:? '?(?!neurotouch)([^?']+?)'?\?")
_OPTION = re.compile(r"(?<![\w-])(--[a-z][\w-]*)(?:[ =]([^\s.;,()]+))?")
_AWAY = re.compile(r"(?:Leave|Without) (?:out )?(--[a-z][\w-]*)")


def read_fixes(call: str, output: str, gaps: Mapping[str, str]) -> list[str]:
    """Returns each call that the answer names, gaps filled; without those about other programs.

    Args:
        call: what was typed.
        output: the answer.
        gaps: what a person puts in place of a word in capitals.
    """
    found = {}
    for line in re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", output).splitlines():
        if _SENTENCE.search(line.strip()):
            for fix in _read_line(call, line.strip()):
                found[fill(fix, gaps)] = None
    return [fix for fix in found if fix != call]


def join(words: Iterable[str]) -> str:
    """Returns words as they are typed; the shell finds files by patterns."""
    plain = re.compile(r"[\w./*~:=,+@%#-]+")
    return " ".join(word if plain.fullmatch(word) else shlex.quote(word) for word in words)


def fill(call: str, gaps: Mapping[str, str]) -> str:
    """Returns the call with words in place of those in capitals."""
    return re.sub(
        r"(?<![\w-])[A-Z]{2,}(?:\.[a-z]+)?(?![\w-])", lambda gap: gaps.get(gap[0], gap[0]), call
    )


def _read_line(call: str, line: str) -> Iterator[str]:
    named = [_END.split(text)[0].strip() for text in _CALL.findall(line)]
    yield from named
    if named:
        return
    if meant := _MEANT.search(line):
        for word in meant[1].split(" or "):
            yield _replace_near(call, word.strip("' "))
    elif away := _AWAY.search(line):
        yield _leave_away(call, away[1])
    elif option := _OPTION.search(line):
        has_value = re.search(r": --", line) or (option[2] or "").isupper()
        yield _add(call, option[1], option[2] if has_value else None)


def _replace_near(call: str, meant: str) -> str:
    """Returns the call with the meant word in place of the one that resembles it most.

    A word in quotes may itself be several.
    """
    words = [word.split(" ") for word in shlex.split(call)]
    inner = [each for word in words[1:] for each in word if each]
    near = max(inner, key=lambda each: difflib.SequenceMatcher(None, each, meant).ratio())
    return join(" ".join(meant if each == near else each for each in word) for word in words)


def _add(call: str, option: str, value: str | None) -> str:
    """Returns the call with an option, in place of the same one if it has it."""
    words = [word for word in shlex.split(call) if word]  # in place of an empty value
    more = [option] if value is None else [option, value]
    if option in words:
        at = words.index(option)
        follows = words[at + 1 : at + 2]
        has_value = bool(follows) and not follows[0].startswith("--")
        return join([*words[:at], *more, *words[at + 1 + has_value :]])
    return join([*words, *more])


def _leave_away(call: str, option: str) -> str:
    words = shlex.split(call)
    if option not in words:
        return call
    at = words.index(option)
    follows = words[at + 1 : at + 2]
    has_value = bool(follows) and not follows[0].startswith("--")
    return join([*words[:at], *words[at + 1 + has_value :]])
