"""Runs commands of this program for the page: a driver, a calibration, a check, a remote page.

Each is the command that a terminal would run, with pipes instead of the terminal.
"""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from typing import Final

from neurotouch_hid.errors import PageError
from neurotouch_hid.page.messages import ProgramNews
from neurotouch_hid.process.own_command import make_own_command

COMMANDS: Final = {
    "camera": ("run", "--show", "nothing"),
    "events": ("run", "--source", "events:", "--show", "nothing"),
    "webcam": ("run", "--source", "video:", "--show", "nothing"),
    "mouse": ("demo", "--mouse", "--show", "lines"),
    "calibrate": ("calibrate",),
    "check": ("doctor", "--json"),
    "setup": ("setup", "--yes"),
}
"""The commands that a browser may start, by name. It cannot add arguments."""

SERVICE: Final = ("pkexec", "systemctl", "start", "neurotouch")
"""The only command of the list that is not ours: ``service``."""

DRIVERS: Final = ("camera", "events", "webcam", "mouse")
MOST_LINES: Final = 400
"""Limit for a program's output; a calibration needs a tenth of it."""

_PATIENCE_S: Final = 5.0
_LOOK_S: Final = 0.05


class Programs:
    """At most one driver and one other program at a time.

    Args:
        tell: called with each line of output, and with the end of each program.
    """

    def __init__(self, tell: Callable[[ProgramNews], object]) -> None:
        self._tell = tell
        self._running: dict[str, asyncio.subprocess.Process] = {}
        self._lines: dict[str, list[str]] = {}
        self._readers: set[asyncio.Task[None]] = set()

    @property
    def news(self) -> list[ProgramNews]:
        """The messages for a browser that connects later: the output of running programs."""
        return [
            {"name": name, "line": line} for name in self._running for line in self._lines[name]
        ]

    async def start(self, name: str, *arguments: str) -> None:
        """Starts a command of the list.

        Args:
            name: a name of the list, or ``remote``.
            arguments: the whole command of ``remote``.

        Raises:
            PageError: there is none of this name, or such a program runs already.
        """
        if name == "service":
            command = [*SERVICE]
        elif arguments or name in COMMANDS:
            command = make_own_command(*(arguments or COMMANDS[name]))
        else:
            raise PageError("There is no such program.")
        if not await self._has_ended(DRIVERS if name in DRIVERS else (name,)):
            raise PageError("It runs already.")
        try:
            process = await asyncio.create_subprocess_exec(
                *command,
                stdin=asyncio.subprocess.PIPE,
                stdout=asyncio.subprocess.DEVNULL if name in DRIVERS else asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.PIPE if name in DRIVERS else asyncio.subprocess.STDOUT,
                start_new_session=True,  # Ctrl-C is for the page's server, which then ends them
            )
        except OSError as error:
            raise PageError(f"'{command[0]}' cannot be started: {error.strerror}.") from error
        self._running[name], self._lines[name] = process, []
        reader = asyncio.create_task(self._read(name, process))
        self._readers.add(reader)
        reader.add_done_callback(self._readers.discard)

    async def _has_ended(self, names: tuple[str, ...]) -> bool:
        """Returns True if none of these programs runs; one that is ending gets time to end.

        A driver answers nobody any more before its process is over.
        """
        deadline = asyncio.get_running_loop().time() + _PATIENCE_S
        while any(name in self._running for name in names):
            if asyncio.get_running_loop().time() > deadline:
                return False
            await asyncio.sleep(_LOOK_S)
        return True

    def answer(self, name: str, text: str) -> None:
        """Sends a line to a program, as if a person had typed it.

        Raises:
            PageError: it does not run.
        """
        process = self._running.get(name)
        if process is None or process.stdin is None:
            raise PageError("That has ended already.")
        process.stdin.write(text.replace("\n", " ").encode() + b"\n")

    async def stop(self, name: str) -> None:
        """Ends a program, if it runs."""
        process = self._running.get(name)
        if process is None:
            return
        for end in (process.terminate, process.kill):
            with suppress(ProcessLookupError):
                end()
            with suppress(TimeoutError):
                await asyncio.wait_for(process.wait(), _PATIENCE_S)
                return

    async def close(self) -> None:
        """Ends them all, and waits until they have ended."""
        await asyncio.gather(*(self.stop(name) for name in list(self._running)))
        await asyncio.gather(*self._readers)

    async def _read(self, name: str, process: asyncio.subprocess.Process) -> None:
        output = process.stderr if name in DRIVERS else process.stdout
        lines = self._lines[name]
        while output is not None:
            try:
                line = (await output.readline()).decode("utf-8", "replace")
            except ValueError:  # longer than any of ours
                continue
            if not line:
                break
            lines.append(line.rstrip())
            del lines[:-MOST_LINES]
            self._tell({"name": name, "line": line.rstrip()})
        code = await process.wait()
        del self._running[name]
        self._tell({"name": name, "code": code})
