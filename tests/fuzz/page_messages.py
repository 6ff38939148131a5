"""Messages of a browser to the page's server, as they come after the token, or instead of it."""

import asyncio
import atexit
import json
import os
import random
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import pytest

from neurotouch_hid.ipc import read_object
from neurotouch_hid.page.browser import Browser
from neurotouch_hid.page.guard import MOST_BYTES, Guard, make_token
from neurotouch_hid.page.hub import Hub
from neurotouch_hid.page.messages import PageMessage
from neurotouch_hid.printable import make_value_printable
from neurotouch_hid.profile import check_profile
from neurotouch_hid.source.simulator.hand_model import read_hand_command
from tests.fuzz.json_values import damage, write

_TRIAL: Final = {
    "width": 40.0,
    "start": [0.0, 0.0],
    "target": [100.0, 50.0],
    "selected": [101.0, 49.0],
    "movement_s": 0.7,
}
_HAND: Final = {
    "do": "hand",
    "at_ms": 5.0,
    "down": True,
    "x_mm": 1.0,
    "y_mm": 2.0,
    "push_x_mm": 3.0,
    "push_y_mm": 0.0,
    "spread_mm": 0.0,
    "twist_rad": 0.1,
    "tremor_mm": 1.0,
    "resting": False,
}
MESSAGES: Final[list[dict[str, Any]]] = [
    {"token": "x" * 32, "hz": 30},
    _HAND,
    _HAND,
    {"do": "rate", "hz": 20},
    {"do": "throughput", "trials": [_TRIAL] * 12},
    {"do": "set", "key": "pinch", "mark": "on_mm", "value": 3.5, "n": 1},
    {"do": "set", "key": "push", "mark": "points", "value": [[0.2, 0.3], [0.8, 0.9]], "n": 2},
    {"do": "set", "key": "push", "mark": "full", "value": 7.0, "n": 3},
    {"do": "set", "key": "layers.menu.pinch", "mark": "expo", "value": 0.2, "n": 4},
    {"do": "bind", "movement": "zoom", "press": "tap", "mode": "toggle", "do_this": "button b"},
    {"do": "bind", "movement": "push_left", "do_this": "stick left", "layer": "", "instead": ""},
    {"do": "unbind", "key": "zoom"},
    {"do": "undo"},
    {"do": "use", "profile": "mine"},
    {"do": "copy", "profile": "racing"},
    *({"do": each} for each in ("pause", "resume", "outputs", "profiles", "picture")),
    *({"do": "start", "what": each} for each in ("check", "nothing")),
    *({"do": "stop", "what": each} for each in ("driver", "check", "nothing")),
    {"do": "answer", "what": "calibrate", "text": "yes"},
]
_PROFILE: Final = """\
version: 1
name: mine
bindings:
  - {when: push, do: {stick: left, range_mm: [1.0, 8.0], curve: {expo: 0.3}}}
  - when: {gesture: pinch, on_mm: 4.0, off_mm: 2.0}
    do: {layer: menu}
layers:
  - name: menu
    bindings:
      - {when: pinch, do: {layer: base}}
"""


def make(rng: random.Random) -> bytes:
    """Returns the bytes of a message, as long as the server lets in at most."""
    return write(damage(rng.choice(MESSAGES), rng), rng)[:MOST_BYTES]


def check(case: bytes) -> None:
    """Gives it to everything that reads messages of a browser.

    Raises:
        AssertionError: an answer is no JSON that a browser takes, or cannot be shown; or the
            profile is broken.
    """
    read_hand_command(case)
    said = read_object(case)
    if said is not None:
        assert not Guard(make_token()).knows(said.get("token"))
    with _elsewhere() as folder:
        for told in _open_page().hear(case):
            answer = json.loads(told, parse_constant=_refuse)
            assert make_value_printable(answer.get("refused", "")) == answer.get("refused", "")
            assert answer.keys() <= PageMessage.__annotations__.keys(), answer
        for path in (folder / "config/neurotouch/profiles").glob("*.yaml"):
            assert check_profile(path).written is not None, path.read_text()


def _refuse(constant: str) -> None:
    raise AssertionError(f"no browser reads {constant}")


class _Page:
    """The page's hub and a browser; programs that it starts end at once."""

    def __init__(self) -> None:
        self._runner = asyncio.Runner()
        self._hub = self._runner.run(self._open())
        self._browser = Browser(None)  # type: ignore[arg-type]  # its words are read here

    async def _open(self) -> Hub:
        count = iter(range(10**9))
        return Hub(edit=True, stamp=lambda: f"version-{next(count)}")

    def hear(self, message: bytes) -> list[str]:
        self._browser._words.clear()
        self._runner.run(self._hub._hear(self._browser, message))
        return list(self._browser._words)

    def close(self) -> None:
        self._runner.run(self._hub.close())
        self._runner.close()


@cache
def _open_page() -> _Page:
    page = _Page()
    atexit.register(page.close)
    return page


@cache
def _make_folder() -> Path:
    folder = TemporaryDirectory()
    atexit.register(folder.cleanup)
    return Path(folder.name)


@contextmanager
def _elsewhere() -> Iterator[Path]:
    """Keeps settings and drivers of this user out; each case has the same files to begin with."""
    folder = _make_folder()
    profiles = folder / "config/neurotouch/profiles"
    for path in profiles.glob("**/*") if profiles.exists() else ():
        if path.is_file():
            path.unlink()
    profiles.mkdir(parents=True, exist_ok=True)
    (profiles / "mine.yaml").write_text(_PROFILE)
    (profiles.parent / "user.yaml").write_text("version: 1\nslots: [mine]\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CONFIG_HOME", str(folder / "config"))
        patch.setenv("RUNTIME_DIRECTORY", str(folder / "run"))
        patch.setenv("PATH", os.defpath)
        patch.setattr("neurotouch_hid.page.programs.make_own_command", lambda *_: ["/bin/true"])
        page = _open_page()
        page._hub._path = (profiles / "mine.yaml").resolve()
        yield folder
