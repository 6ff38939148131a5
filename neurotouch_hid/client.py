"""The running driver as other processes reach it: where its socket is, and one question to it.

A question is one line of JSON, ``{"command": "pause"}``, and so is its answer: ``ok``, with
``text`` for people if it was done, else with ``error`` and perhaps ``hint``. Only the standard
library is imported here, so that ``neurotouch panic`` is there at once.
"""

import json
import socket
import time
from contextlib import suppress
from pathlib import Path
from typing import Any, Final, NotRequired, TypedDict, cast

from neurotouch_hid.errors import DriverError, NotRunningError
from neurotouch_hid.players import (
    SERVICE_FOLDER,
    explain_start,
    find_socket,
    list_runtime_folders,
)

LIMIT_BYTES: Final = 1024 * 1024
"""The longest question or answer: a person's settings, which are handed over whole."""

REQUEST_S: Final = 1.0
"""A question must be there, and is answered, within this time."""

LOADING_S: Final = 10.0
"""What has a profile loaded, ``reload`` or ``use``, is answered within this time: the answer says
what came of it."""

ENDING_S: Final = 10.0
"""A driver that was asked to end has ended within this time."""

_PATIENCE_S: Final = 3 * REQUEST_S
_AGAIN_S: Final = 0.1

Answer = dict[str, Any]

StageSpread = TypedDict("StageSpread", {"p50": float, "p99": float, "p99.9": float})
"""Percentiles of the time in a stage since the start, in ms a slice."""


class Fatigue(TypedDict):
    """A movement that fades.

    Attributes:
        movement: its name, as in the person's ranges.
        peak_mm: how far it goes now.
        full_mm: what the range could be set to; None while it need not be.
        needs: the share of its range that it needs now; 1 without help.
    """

    movement: str
    peak_mm: float
    full_mm: float | None
    needs: float


class ErrorNote(TypedDict):
    """What went wrong: a sentence, and when, in s since 1970."""

    at: float
    error: str


class PipelineStatus(TypedDict):
    """What a running pipeline says of itself.

    Attributes:
        pid: the driver's process.
        state: ``running``, ``paused`` or ``panic``.
        profile: name of the profile that is active.
        layer: name of its layer that is active.
        markers_tracked: how many of the 177 are measured.
        gel: ``found``, or what keeps it from being found.
        gesture: the gesture now, ``none`` at rest.
        ignored: the last gesture that came to nothing, and why, in a sentence; None without.
        silent_s: for how long nothing has come from the source; 0 while it comes.
        uptime_s: since the start.
        slices: since the start.
        slices_hz: slices per second.
        events_hz: events per second.
        events_lost: since the start.
        stage_ms: mean host time a slice, by stage.
        stage_spread_ms: its percentiles since the start.
        fatigue: movements that fade.
        long_holds: how often each movement was held for more than 5 s.
        errors: the newest errors.
    """

    pid: int
    state: str
    profile: str
    layer: str
    markers_tracked: int
    gel: str
    gesture: str
    ignored: str | None
    silent_s: float
    uptime_s: float
    slices: int
    slices_hz: float
    events_hz: int
    events_lost: int
    stage_ms: dict[str, float]
    stage_spread_ms: dict[str, StageSpread]
    fatigue: list[Fatigue]
    long_holds: dict[str, int]
    errors: list[ErrorNote]


class Status(PipelineStatus):
    """The answer to ``status``: the pipeline's, and what surrounds it in a sentence each.

    Attributes:
        version: of this format: 1.
        source: what is played.
        device: the virtual gamepad.
        keyboard: which keyboards can stop the driver.
        desktop: which window has chosen the profile.
        sound: how the driver is heard.
        settings: whose settings apply.
        copilot: the physical device that plays along.
        mouse: which mice are watched.
        rumble: how games shake the pad.
    """

    version: int
    source: str
    device: str
    keyboard: str
    desktop: str
    sound: str
    settings: str
    copilot: NotRequired[str]
    mouse: NotRequired[str]
    rumble: NotRequired[str]


def ask(command: str, *, player: int | None = None, **arguments: Any) -> Answer:
    """Returns the running driver's answer to a command.

    Args:
        command: ``pause``, ``resume``, ``panic``, ``reload``, ``status``, ``use`` or ``settings``.
        player: whose driver; as the environment says without.
        arguments: what the command needs: ``profile``, a name or an absolute path, for ``use``; for
            ``settings`` see ``handover``.

    Raises:
        NotRunningError: no driver is running.
        DriverError: it does not answer, or it refuses.
    """
    question = json.dumps({"command": command, **arguments}).encode() + b"\n"
    patience_s = _PATIENCE_S + (LOADING_S if command in ("reload", "use", "settings") else 0.0)
    answer, line = _ask_any(question, patience_s, player)
    line.close()
    if answer.get("ok") is not True:
        raise DriverError(str(answer.get("error")), hint=answer.get("hint"))
    return answer


def ask_status() -> Status:
    """Returns what the running driver says of itself.

    Raises:
        NotRunningError: no driver is running.
        DriverError: it does not answer.
    """
    return cast(Status, ask("status"))


def open_stream(command: str) -> tuple[Answer, socket.socket]:
    """Returns the running driver's answer, and the socket on which it goes on speaking.

    Args:
        command: ``record``: packets follow, until either end closes.

    Raises:
        NotRunningError: no driver is running.
        DriverError: it does not answer, or it refuses.
    """
    answer, line = _ask_any(json.dumps({"command": command}).encode() + b"\n", _PATIENCE_S)
    if answer.get("ok") is not True:
        line.close()
        raise DriverError(str(answer.get("error")), hint=answer.get("hint"))
    line.settimeout(None)
    return answer, line


def is_service_running() -> bool:
    """Returns whether the system's service runs, whether or not this user may ask it."""
    return is_served(SERVICE_FOLDER)


def is_served(folder: Path) -> bool:
    """Returns whether a driver listens in a folder, of whatever user."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as line:
        line.settimeout(REQUEST_S)
        try:
            line.connect(str(find_socket(folder)))
        except OSError:
            return False
    return True


def is_driver_running() -> bool:
    """Returns whether a driver of the environment's player runs that this user may ask."""
    try:
        ask_status()
    except DriverError:
        return False
    return True


def wait_until_ended(player: int) -> None:
    """Waits until no driver of this player listens any more.

    Raises:
        DriverError: it still listens after 10 s.
    """
    deadline = time.monotonic() + ENDING_S
    while any(map(is_served, list_runtime_folders(player))):
        if time.monotonic() > deadline:
            raise DriverError(
                f"The driver has not ended within {ENDING_S:g} s.",
                hint="Its pad is released. See: neurotouch status",
            )
        time.sleep(_AGAIN_S)


def _ask_any(
    question: bytes, patience_s: float, player: int | None = None
) -> tuple[Answer, socket.socket]:
    for path in map(find_socket, list_runtime_folders(player)):
        try:
            return _ask_patiently(path, question, patience_s)
        except (FileNotFoundError, NotADirectoryError, ConnectionRefusedError):
            continue  # nobody is there: no socket, or one that its driver has left behind
        except TimeoutError:
            raise DriverError(
                "The driver does not answer.", hint="Is it still starting? Try again in a moment."
            ) from None
        except OSError as error:
            raise DriverError(f"The driver cannot be reached: {error.strerror} ({path}).") from None
        except ValueError:
            raise DriverError(f"What answers at {path} is not a driver.") from None
    raise NotRunningError("No driver is running.", hint=explain_start())


def _ask_patiently(path: Path, question: bytes, patience_s: float) -> tuple[Answer, socket.socket]:
    """Returns the answer and the open line; while the driver is busy with others, asks again."""
    deadline = time.monotonic() + patience_s
    while time.monotonic() < deadline:
        with suppress(BlockingIOError):  # its queue is full
            answer, line = _ask_once(path, question, patience_s)
            if not answer.get("busy"):
                return answer, line
            line.close()
        time.sleep(_AGAIN_S)
    raise TimeoutError


def _ask_once(path: Path, question: bytes, patience_s: float) -> tuple[Answer, socket.socket]:
    line = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        line.settimeout(patience_s)
        line.connect(str(path))
        with suppress(BrokenPipeError, ConnectionResetError):  # refused unread; the answer says why
            line.sendall(question)
        answer = json.loads(_read_line(line))
        if not isinstance(answer, dict):
            raise ValueError
    except (OSError, ValueError):
        line.close()
        raise
    return answer, line


def _read_line(line: socket.socket) -> bytes:
    """Returns a line of text, and not a byte more: what comes after it may be no text."""
    text = b""
    while len(text) <= LIMIT_BYTES:
        ahead = line.recv(4096, socket.MSG_PEEK)
        piece = line.recv(ahead.find(b"\n") + 1 or len(ahead)) if ahead else b""
        text += piece
        if not piece or text.endswith(b"\n"):
            break
    return text
