"""Makes text from elsewhere fit to be shown: file names, profiles, answers, names of devices."""

from typing import Any, Final

_JOINERS: Final = "\u200c\u200d"
"""They have no picture either, but Persian and the scripts of India cannot be written without."""


def is_printable(char: str) -> bool:
    """Returns whether a character shows itself, and changes nothing of what is around it."""
    return char.isprintable() or char in _JOINERS


def make_printable(text: str) -> str:
    """Returns the text in one line, with nothing in it that could move a terminal's cursor."""
    if text.isprintable():
        return text
    return "".join(char if is_printable(char) else " " if char == "\t" else "�" for char in text)


def make_lines_printable(text: str) -> str:
    """Returns the same for several lines, which stay lines."""
    return "\n".join(map(make_printable, text.split("\n")))


def make_value_printable(value: Any) -> Any:
    """Returns the same for every text in a value that was read from JSON, keys included."""
    match value:
        case str():
            return make_lines_printable(value)
        case dict():
            return {make_printable(key): make_value_printable(each) for key, each in value.items()}
        case list():
            return [make_value_printable(each) for each in value]
        case _:
            return value
