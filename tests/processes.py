"""Commands as processes of their own: those that end by themselves, driver and page."""

import json
import os
import re
import socket
import subprocess
import sys
from pathlib import Path
from typing import Any

from tests.repeated import find_tour, offer_repeated
from tests.waiting import LIMIT_S, wait_until

PROGRAM = [sys.executable, "-m", "neurotouch_hid"]


def run_command(
    *command: object, code: int | None = 0, **options: Any
) -> subprocess.CompletedProcess[str]:
    """Runs a command to its end, with this exit code unless it is None."""
    settings = {"capture_output": True, "text": True, "timeout": LIMIT_S} | options
    done = subprocess.run([*map(str, command)], check=False, **settings)
    assert code in (None, done.returncode), done.stdout + done.stderr
    return done


def run_neurotouch(*arguments: object, **options: Any) -> subprocess.CompletedProcess[str]:
    """Runs a command of ours to its end, see ``run_command``."""
    return run_command(*PROGRAM, *arguments, **options)


def start_neurotouch(*arguments: object, **options: Any) -> subprocess.Popen[str]:
    """Starts a command of ours; what it says can be read."""
    settings = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True} | options
    return subprocess.Popen([*PROGRAM, *map(str, arguments)], **settings)


def make_environment(folder: Path) -> dict[str, str]:
    """The environment of somebody with folders of their own."""
    return {
        **os.environ,
        "RUNTIME_DIRECTORY": str(folder / "run"),
        "XDG_CONFIG_HOME": str(folder / "config"),
    }


class Process:
    """A command of ours that runs until the test ends it."""

    def __init__(
        self,
        folder: Path,
        *arguments: str,
        ready: str,
        program: list[str] = PROGRAM,
        **variables: str | None,
    ) -> None:
        folder.mkdir(exist_ok=True)
        self.folder = folder
        wanted = make_environment(folder) | variables
        self.environment = {name: value for name, value in wanted.items() if value is not None}
        self._log = folder / f"{arguments[0] if arguments else 'program'}.txt"
        with self._log.open("w") as log:
            self.process = subprocess.Popen(
                [*program, *arguments],
                stdout=log,
                stderr=subprocess.STDOUT,
                stdin=subprocess.DEVNULL,
                env=self.environment,
            )
        self.wait(lambda: ready in self.said)

    @property
    def said(self) -> str:
        return self._log.read_text()

    def wait(self, happened) -> None:
        """Waits until it has happened; the command must still run."""

        def has_happened() -> bool:
            assert self.process.poll() is None, self.said
            return happened()

        wait_until(has_happened, lambda: self.said)

    def call(self, *arguments: str) -> subprocess.CompletedProcess:
        options = {"env": self.environment, "stdin": subprocess.DEVNULL}
        return run_neurotouch(*arguments, code=None, **options)

    def end(self) -> None:
        self.process.terminate()
        try:
            self.process.wait(LIMIT_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


class Driver(Process):
    """``neurotouch run`` on a simulated gel, whose tour was recorded."""

    def __init__(self, folder: Path, source: str | None = None, profile: str = "mine") -> None:
        source = source or f"repeated:{find_tour()}"
        super().__init__(
            folder,
            *("run", "--source", source, "--device", "memory", "--profile", profile),
            *("--show", "nothing"),
            ready="Gamepad ready",
            **offer_repeated(folder / "packages"),
        )

    def status(self) -> dict:
        with socket.socket(socket.AF_UNIX) as line:
            line.settimeout(LIMIT_S)
            line.connect(str(self.folder / "run" / "control"))
            line.sendall(b'{"command": "status"}\n')
            return json.loads(line.makefile().readline())


class View(Process):
    """``neurotouch view``."""

    def __init__(self, folder: Path, *arguments: str, **how: Any) -> None:
        command = ("view", "--port", "0", *arguments)
        super().__init__(folder, *command, ready="Spacecraft: ", **how)
        self.link = re.search(r"Live view: (\S+)", self.said)[1]
        self.home = re.search(r"Page: (\S+)", self.said)[1]
        self.root, self.token = self.home.split("#k=")
        self.port = int(self.root.rstrip("/").rsplit(":", 1)[1])

    def page(self, name: str) -> str:
        return f"{self.root}{name}#k={self.token}"
