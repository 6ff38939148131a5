"""Messages in JSON, damaged: values of other kinds, beyond every bound, and bytes that are none."""

import json
import random
from copy import deepcopy
from typing import Any, Final

HUGE: Final = 10**400

VALUES: Final = [
    *(None, True, False, 0, -1, 1, 7, 60, 0.5, -0.0, 1e308, -1e308, 1e-320, 2**31, 2**63, 10**16),
    *(HUGE, -HUGE, float("inf"), float("-inf"), float("nan")),
    *("", " ", "x", "base", "pinch", "push_left", "button a", "stick left", "racing", "mine"),
    *("user", "../user", "/dev/zero", "/etc/shadow", "/\0", "\ud800", "/tmp/\ud800.yaml"),
    *("\x1b]0;x\a", "\u202e", "\x9b2K", "\n", "\r\nOK", "é" * 60, "x" * 101, "x" * 5000, "🙂"),
    *("1", "nan", "layers.menu.pinch", "bindings[0]", "pinch.do", "curve", "{}", "{x: 1}", "&a"),
    *([], {}, [[]], [1, 2], [["a", "b"]], [[0.0, 0.0], [1.0, 1.0]], {"x": 1}, {"": {}}),
]
PIECES: Final = [
    *(b"\x00", b"\xff", b"\xc3", b"\n", b"\r\n", b'"', b"\\", b"\\ud800", b"{", b"}", b"[" * 2000),
    *(b"1e999", b"9" * 5000, b"-", b",", b":", b"NaN", b"Infinity", b"/*", b"\xef\xbb\xbf", b" "),
]


def damage(message: dict[str, Any], rng: random.Random) -> dict[str, Any]:
    """Returns a message with none to three values that do not belong there."""
    damaged = deepcopy(message)
    for _ in range(rng.choice((0, 1, 1, 2, 3))):
        key = rng.choice([*damaged, *damaged, "token", "n", "\ud800", ""])
        match rng.randrange(5):
            case 0:
                damaged.pop(key, None)
            case 1:
                damaged[key] = nest(rng.choice(VALUES), rng.choice((1, 3, 40, 400)), rng)
            case 2 if isinstance(damaged.get(key), list) and damaged[key]:
                damaged[key][rng.randrange(len(damaged[key]))] = rng.choice(VALUES)
            case _:
                damaged[key] = rng.choice(VALUES)
    return damaged


def nest(value: Any, depth: int, rng: random.Random) -> Any:
    """Returns a value inside so many lists or objects."""
    for _ in range(depth):
        value = [value] if rng.random() < 0.5 else {"a": value}
    return value


def write(message: dict[str, Any], rng: random.Random) -> bytes:
    """Returns a message as bytes; of some a piece is missing, wrong or too much."""
    text = bytearray(json.dumps(message, ensure_ascii=rng.random() < 0.5).encode(errors="replace"))
    for _ in range(rng.choice((0, 0, 0, 1, 3))):
        at = rng.randint(0, len(text))
        text[at : at + rng.choice((0, 0, 1, 5))] = rng.choice(PIECES)
    return bytes(text)
