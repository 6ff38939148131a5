"""What all chapters share: the camera, the package, and where the results go."""

import shutil
from dataclasses import dataclass
from pathlib import Path

from tests.system.guest.camera import Camera
from tests.system.guest.observation import (
    PEOPLE,
    PLAYER,
    SERVICE,
    Reader,
    find_pad,
    main_pid,
    run,
    wait_for,
)


@dataclass(slots=True)
class Desk:
    """The machine under test.

    Attributes:
        results: the folder shared with the host.
        package: the .deb.
        camera: what is plugged and pulled; None in a container, which has no pad either.
    """

    results: Path
    package: Path
    camera: Camera | None

    def read_pad(self) -> Reader:
        """Somebody who reads the pad, as soon as it is there."""
        return Reader(wait_for(find_pad))

    def play_until_pushed(self) -> Reader:
        """The same, at a moment when the gel holds the stick out."""
        reader = self.read_pad()
        wait_for(reader.is_pushed)
        return reader

    def forget_choice(self) -> None:
        """The player has saved nothing again, so the machine's values apply."""
        run("systemctl", "stop", SERVICE)
        for folder in (f"/home/{PLAYER}/.config/neurotouch", PEOPLE):  # the service has a copy
            shutil.rmtree(folder, ignore_errors=True)
        run("systemctl", "start", SERVICE)
        self.read_pad()

    def identity(self) -> tuple[str | None, int]:
        """The pad's node and the service's process: neither may change while it plays."""
        return find_pad(), main_pid()
