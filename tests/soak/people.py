"""Does to a running driver what people do, from a process of its own.

``python -m tests.soak.people`` reads the name of an action from each line, does it, and answers
with a line: ``done``, or what went wrong. Random choices come from the seed that it is given.
"""

import random
import socket
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack, suppress
from itertools import islice

from neurotouch_hid.client import ask
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.ipc import FEED, connect_to
from neurotouch_hid.players import find_runtime_folder, find_socket
from neurotouch_hid.profile.reading.library import find_user_folder
from neurotouch_hid.source.running_driver import RunningDriver
from neurotouch_hid.subscriber import Subscriber

PROFILES = ("default", "racing", "spacecraft", "mouse")
PLAYED = PROFILES[0]
"""The profile of the undisturbed stretches."""

Action = Callable[[random.Random], object]


def pause(chance: random.Random) -> None:
    """Pauses and resumes, a few times."""
    for _ in range(chance.randint(1, 3)):
        ask("pause")
        ask("resume")


def panic(chance: random.Random) -> None:
    """Stops everything, and resumes."""
    ask("panic")
    ask("status")
    ask("resume")


def change_profile(chance: random.Random) -> None:
    """Uses other profiles."""
    for _ in range(chance.randint(1, 3)):
        ask("use", profile=chance.choice(PROFILES))


def save_profile(chance: random.Random) -> None:
    """Saves a profile of the person's own while it is played: right, wrong, and right again."""
    path = find_user_folder() / "own.yaml"
    text = "name: own\nversion: 1\nextends: [racing]\n"
    path.write_text(text)
    try:
        ask("use", profile="own")
        for content in ("extends: [", f"{text}# {chance.random()}\n"):
            path.write_text(content)
            with suppress(NeuroTouchError):
                ask("reload")
        ask("use", profile=PLAYED)
    finally:
        path.unlink()


def view(chance: random.Random) -> None:
    """Connects up to four viewers; most read nothing, and all leave without a word."""
    with ExitStack() as stack:
        viewers = [stack.enter_context(Subscriber()) for _ in range(chance.randint(1, 4))]
        for viewer in viewers:
            viewer.connect()
            viewer.want(chance.choice((1, 30, 60)))
        for _ in range(5):
            time.sleep(0.02)
            viewers[0].take()


def view_too_many(chance: random.Random) -> None:
    """More viewers than the driver takes."""
    with ExitStack() as stack:
        for _ in range(12):
            with suppress(OSError):
                stack.enter_context(connect_to(find_runtime_folder() / FEED))
        time.sleep(0.02)


def record(chance: random.Random) -> None:
    """Takes some of the driver's packets, as ``neurotouch record`` does, and leaves."""
    with RunningDriver() as packets:
        for _ in islice(packets, chance.randint(1, 50)):
            pass


def chatter(chance: random.Random) -> None:
    """Sends nonsense, half a question, and nothing at all to the control socket."""
    for question in (chance.randbytes(40) + b"\n", b'{"command": "pau', b"", b"[]\n"):
        with socket.socket(socket.AF_UNIX) as line, suppress(OSError):
            line.settimeout(3.0)
            line.connect(str(find_socket(find_runtime_folder())))
            line.send(question)
            if question.endswith(b"\n"):
                line.recv(1000)


def use_all(_: random.Random) -> None:
    """Uses each profile once, so that every device that they need has been opened."""
    for profile in PROFILES:
        ask("use", profile=profile)


def settle(_: random.Random) -> None:
    """Leaves the driver as it was at the start."""
    ask("resume")
    ask("use", profile=PLAYED)


ACTIONS: dict[str, Action] = {
    action.__name__: action
    for action in (
        pause,
        panic,
        change_profile,
        save_profile,
        view,
        view_too_many,
        record,
        chatter,
    )
}


def main() -> None:
    """Answers until its input ends."""
    chance = random.Random(sys.argv[1])
    for line in sys.stdin:
        try:
            (ACTIONS | {"settle": settle, "use_all": use_all})[line.strip()](chance)
            print("done", flush=True)
        except (NeuroTouchError, OSError) as error:
            print(f"{line.strip()}: {error!r}", flush=True)


if __name__ == "__main__":
    main()
