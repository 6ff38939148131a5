"""Questions to control sockets: each gets one line of answer, and so does the next question."""

import atexit
import json
import os
import random
import socket
import threading
from contextlib import suppress
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final
from zlib import crc32

from neurotouch_hid.client import LIMIT_BYTES
from neurotouch_hid.driver.chosen import Chosen
from neurotouch_hid.driver.commands import Commands
from neurotouch_hid.driver.control_socket import ControlSocket
from neurotouch_hid.driver.packet_feed import PacketFeed
from neurotouch_hid.driver.people import People
from neurotouch_hid.driver.profile_watch import ProfileWatch
from neurotouch_hid.driver.program_pauses import ProgramPauses
from neurotouch_hid.driver.surroundings import Surroundings
from neurotouch_hid.driver.told_window import ToldWindow
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.players import find_socket
from neurotouch_hid.printable import make_value_printable
from neurotouch_hid.profile import UserSettings, load_profile
from neurotouch_hid.runtime import Pipeline, PipelineControl
from neurotouch_hid.source import open_source
from neurotouch_hid.status import check_status
from tests.driver.test_commands import DESCRIBED
from tests.fuzz.json_values import damage, write

LIMIT_S: Final = 15.0
_PROFILE: Final = "version: 1\nname: mine\nbindings:\n  - {when: pinch, do: {button: a}}\n"
_SETTINGS: Final = {"folder": "/home/x", "user": "version: 1\n", "profiles": {"mine": _PROFILE}}
QUESTIONS: Final[list[dict[str, Any]]] = [
    *({"command": each} for each in ("pause", "resume", "panic", "stop", "status", "record")),
    *({"command": "use", "profile": each} for each in ("racing", "nine", "/dev/zero", "/x")),
    {"command": "reload"},
    {"command": "window", "profile": "racing", "window": "game is in front (sway)"},
    {"command": "settings", **_SETTINGS},
    {"command": "settings", "folder": "/home/x", "user": None, "profiles": {}},
]


def make(rng: random.Random) -> bytes:
    """Returns the bytes of a question."""
    question = write(damage(rng.choice(QUESTIONS), rng), rng)
    if rng.random() < 0.003:
        question += b" " * LIMIT_BYTES
    return question + rng.choice((b"\n", b"\n", b"\n", b"", b"\nmore\n"))


def check(case: bytes) -> None:
    """Asks it, and then what the driver does.

    Raises:
        AssertionError: no answer, or one that is none.
    """
    service = _open_driver(is_service=crc32(case) % 2 == 0)
    answer = _exchange(service.path, case)
    assert isinstance(answer, dict), answer
    assert isinstance(answer.get("ok"), bool), answer
    if not answer["ok"]:
        assert isinstance(answer["error"], str), answer
        assert make_value_printable(answer) == answer, answer
        assert len(answer["error"]) < 4000, answer
    status = _exchange(service.path, b'{"command": "status"}\n')
    check_status(status)
    assert make_value_printable(status) == status, status
    assert service.faults == [], service.faults


class _Driver:
    """A driver without a pad, whose pipeline does nothing but apply commands."""

    def __init__(self, folder: Path, *, is_service: bool) -> None:
        self.faults: list[str] = []
        threading.excepthook = lambda fault: self.faults.append(repr(fault.exc_value))
        profile, user = load_profile("default"), UserSettings()
        control = PipelineControl(Pipeline.build(profile, GestureConfig(), user=user), user)
        seated = People(folder / "people", find_seated=lambda: [os.geteuid()])
        around = Surroundings(people=seated if is_service else None, default="default")
        watch = ProfileWatch(Chosen("default", profile, user), control, around, lambda _new: None)
        source = open_source("sim:tour", speed="max")
        window = ToldWindow(seated.is_present, watch.follow) if is_service else None
        commands = Commands(
            control,
            watch,
            PacketFeed(),
            ProgramPauses(control),
            source,
            around,
            lambda: DESCRIBED,
            window,
        )
        self.path = find_socket(folder / "run")
        listener = ControlSocket(folder / "run")
        listener.serve(commands.answer)
        ended = threading.Event()

        def apply() -> None:
            while not ended.wait(0.001):
                control.apply_commands()

        pipeline = threading.Thread(target=apply, daemon=True)
        pipeline.start()

        def close() -> None:
            listener.close()
            ended.set()
            pipeline.join()
            if window is not None:
                window.close()
            watch.close()

        atexit.register(close)


@cache
def _open_driver(*, is_service: bool) -> _Driver:
    folder = TemporaryDirectory()
    atexit.register(folder.cleanup)
    return _Driver(Path(folder.name), is_service=is_service)


def _exchange(path: Path, question: bytes) -> Any:
    with socket.socket(socket.AF_UNIX) as connection:
        connection.settimeout(LIMIT_S)
        connection.connect(str(path))
        with suppress(BrokenPipeError, ConnectionResetError):  # refused before all was said
            connection.sendall(question)
            connection.shutdown(socket.SHUT_WR)
        text = b""
        while not text.endswith(b"\n"):
            piece = connection.recv(65536)
            assert piece, "closed without an answer"
            text += piece
    return json.loads(text)
