"""Address of this person's running page server, for the other commands."""

import errno
import json
import os
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_text
from neurotouch_hid.ipc import find_believed
from neurotouch_hid.page.guard import make_ticket
from neurotouch_hid.players import find_runtime_folder

FILE: Final = "page.json"


@dataclass(frozen=True, slots=True)
class Address:
    """A server that runs, or ran.

    Attributes:
        url: its root, ``http://127.0.0.1:7878/``.
        token: its secret.
        pid: its process.
        may_edit: True if its page may change the profile.
    """

    url: str
    token: str
    pid: int
    may_edit: bool = False

    def link(self, page: str = "") -> str:
        """Returns the link that opens a page: browsers never send its fragment, the secret."""
        return f"{self.url}{page}#k={self.token}"

    def link_for_browser(self, page: str = "") -> str:
        """Returns the same for a program that is started with it: no secret is in it."""
        return f"{self.url}open/{make_ticket(self.token)}/{page}"


def find_address_file() -> Path:
    """Returns the file with the address; only its owner can read it."""
    return find_runtime_folder() / FILE


def write_address(address: Address) -> Path:
    """Writes the address to a file, for other commands of this person.

    Raises:
        OSError: the file cannot be written.
    """
    part = write_secret(f"page.{os.getpid()}", json.dumps(asdict(address)))
    return part.replace(find_address_file())


def write_secret(name: str, text: str) -> Path:
    """Writes a file that only this user can read, in the folder of this user's driver.

    Raises:
        OSError: it cannot be written, or the folder is a stranger's.
    """
    path = find_runtime_folder() / name
    path.parent.mkdir(mode=0o700, exist_ok=True)
    if not find_believed(path.parent):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path.parent))
    path.unlink(missing_ok=True)
    # Neither a link nor a file that another user has just put there is opened.
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o600)
    with os.fdopen(descriptor, "w") as file:
        file.write(text)
    return path


def read_address() -> Address | None:
    """Returns the server that runs for this person, or None."""
    address = _read_file()
    if address is not None:
        with suppress(OSError, TypeError):  # it has ended
            os.kill(address.pid, 0)
            return address
    return None


def forget_address(pid: int) -> None:
    """Removes the file if it still names this process, which may have ended."""
    address = _read_file()
    if address is not None and address.pid == pid:
        find_address_file().unlink(missing_ok=True)


def _read_file() -> Address | None:
    with suppress(OSError, ValueError, KeyError, TypeError):
        path = find_address_file()
        if path.lstat().st_uid == os.geteuid():
            said = json.loads(read_text(path, MAX_SETTINGS_BYTES))
            return Address(said["url"], said["token"], said["pid"], said.get("may_edit") is True)
    return None
