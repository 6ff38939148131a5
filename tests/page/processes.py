"""The driver and the page's server as processes of their own, with folders of their own."""

import json
import os
import re
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

PROGRAM = [sys.executable, "-m", "neurotouch_hid"]
LIMIT_S = 180.0


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
        changed = {
            "RUNTIME_DIRECTORY": str(folder / "run"),
            "XDG_CONFIG_HOME": str(folder / "config"),
            **variables,
        }
        kept = {name: value for name, value in os.environ.items() if name not in changed}
        self.environment = kept | {name: value for name, value in changed.items() if value}
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
        deadline = time.monotonic() + LIMIT_S
        while not happened():
            assert self.process.poll() is None, self.said
            assert time.monotonic() < deadline, self.said
            time.sleep(0.05)

    def call(self, *arguments: str) -> subprocess.CompletedProcess:
        return subprocess.run(
            [*PROGRAM, *arguments],
            capture_output=True,
            text=True,
            check=False,
            env=self.environment,
            timeout=LIMIT_S,
            stdin=subprocess.DEVNULL,
        )

    def end(self) -> None:
        self.process.terminate()
        try:
            self.process.wait(LIMIT_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


class Driver(Process):
    """``neurotouch run`` on a simulated gel."""

    def __init__(self, folder: Path, scene: str = "tour", profile: str = "mine") -> None:
        super().__init__(
            folder,
            *("run", "--source", f"sim:{scene}", "--device", "memory", "--profile", profile),
            *("--show", "nothing"),
            ready="Gamepad ready",
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
