"""What a browser may ask for, and what is done about it."""

import asyncio
import re
import socket
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any, Final

from neurotouch_hid.client import ask, is_served
from neurotouch_hid.errors import PageError, ProfileError
from neurotouch_hid.page.edits import Changes, Wish
from neurotouch_hid.page.guard import make_token
from neurotouch_hid.page.outputs import list_outputs
from neurotouch_hid.page.own_values import OwnValues, load_usable_user
from neurotouch_hid.page.pictures import draw_code, take_picture
from neurotouch_hid.page.programs import DRIVERS, Programs
from neurotouch_hid.page.situation import MENDS
from neurotouch_hid.players import find_runtime_folder
from neurotouch_hid.profile import Profile, check_profile, list_profiles
from neurotouch_hid.profile.reading.library import find_user_folder

Request = dict[str, Any]
Reply = dict[str, Any]
Handler = Callable[[Request, Path], Awaitable[Reply]]

REMOTE_S: Final = 3600.0
"""The right of another device to this page ends by itself."""

_REMOTE_FILE: Final = "remote-token"
_FAR_LINK = re.compile(r"From other machines: (\S+)#k=TOKEN")


class Requests:
    """Carries out what browsers ask for.

    Args:
        edit: whether anything may be changed.
        is_far: the page is served to other machines, and may not let in more.
        changes: saves what belongs to a profile.
        own: saves what belongs to the person.
        tell_all: tells every browser something.
        remote_s: for how long another device may see this page.
    """

    def __init__(
        self,
        *,
        edit: bool,
        is_far: bool,
        changes: Changes,
        own: OwnValues,
        tell_all: Callable[[Reply], object],
        remote_s: float = REMOTE_S,
    ) -> None:
        self._edit, self._is_far = edit, is_far
        self._changes, self._own = changes, own
        self._tell_all = tell_all
        self._programs = Programs(self._hear_program)
        self._token = ""
        self._remote: Reply | None = None
        self._remote_s = remote_s
        self._expiry: asyncio.TimerHandle | None = None
        self._looks: dict[str, Handler] = {
            "outputs": self._list_outputs,
            "profiles": self._list_profiles,
            "picture": self._take_picture,
        }
        self._changers: dict[str, Handler] = {
            "set": self._set,
            "undo": self._undo,
            "bind": self._bind,
            "unbind": self._unbind,
            "use": self._use,
            "copy": self._copy,
            "pause": self._command,
            "resume": self._command,
            "start": self._start,
            "stop": self._stop,
            "answer": self._answer,
            "remote": self._let_in,
            "own value": self._set_own,
            "undo own values": self._undo_own,
            "undo calibration": self._undo_calibration,
            "mend own values": self._mend_own,
        }

    @property
    def news(self) -> list[Reply]:
        """What a browser that comes later needs to be told."""
        remote = [] if self._remote is None else [{"remote": self._remote}]
        return [{"program": each} for each in self._programs.news] + remote

    async def carry_out(self, request: Request, file: Path) -> Reply:
        """Returns the answer to a request.

        Args:
            request: of the browser; ``do`` says what.
            file: the active profile.

        Raises:
            NeuroTouchError: it cannot be done, or may not.
        """
        verb = str(request.get("do"))
        if verb in self._looks:
            return await self._looks[verb](request, file)
        if verb not in self._changers:
            raise PageError("There is no such request.")
        if not self._edit:
            raise PageError(
                "This page only shows.", hint="To change things: neurotouch view --edit"
            )
        return await self._changers[verb](request, file)

    async def close(self) -> None:
        """Ends everything that was started."""
        await self._programs.close()

    async def _set(self, request: Request, file: Path) -> Reply:
        key, mark = str(request.get("key")), str(request.get("mark"))
        said = await asyncio.to_thread(self._changes.set, file, key, mark, request.get("value"))
        return {"saved": said}

    async def _undo(self, _request: Request, file: Path) -> Reply:
        return {"saved": await asyncio.to_thread(self._changes.undo, file)}

    async def _bind(self, request: Request, file: Path) -> Reply:
        parts = ("movement", "press", "mode", "do_this", "layer", "instead")
        wish = Wish(*(str(request.get(part) or "")[:80] for part in parts))
        return {"saved": await asyncio.to_thread(self._changes.bind, file, wish)}

    async def _unbind(self, request: Request, file: Path) -> Reply:
        key = str(request.get("key"))
        return {"saved": await asyncio.to_thread(self._changes.unbind, file, key)}

    async def _use(self, request: Request, _file: Path) -> Reply:
        name = str(request.get("profile"))
        return {"saved": await asyncio.to_thread(self._changes.use, _take_name(name))}

    async def _copy(self, request: Request, _file: Path) -> Reply:
        name = str(request.get("profile"))
        return {"saved": await asyncio.to_thread(self._changes.copy, _take_name(name))}

    async def _set_own(self, request: Request, _file: Path) -> Reply:
        name, value = str(request.get("name")), str(request.get("value"))
        return {"saved": await asyncio.to_thread(self._own.set, name, value)}

    async def _undo_own(self, _request: Request, _file: Path) -> Reply:
        return {"saved": await asyncio.to_thread(self._own.undo)}

    async def _undo_calibration(self, _request: Request, _file: Path) -> Reply:
        return {"saved": await asyncio.to_thread(self._own.undo_calibration)}

    async def _mend_own(self, _request: Request, _file: Path) -> Reply:
        return {"saved": await asyncio.to_thread(self._own.mend)}

    async def _command(self, request: Request, _file: Path) -> Reply:
        answer = await asyncio.to_thread(ask, request["do"])
        # The next state says what is done, beside the button that takes it back.
        return {"saved": "" if answer.get("done") else str(answer.get("text"))}

    async def _start(self, request: Request, _file: Path) -> Reply:
        name = str(request.get("what"))
        if name == "remote":
            raise PageError("There is no such program.")
        if name in MENDS.values() and self._is_far:
            raise PageError("Only the machine itself may ask for its password.")
        if name in DRIVERS and await asyncio.to_thread(is_served, find_runtime_folder()):
            raise PageError("A driver of yours runs already.", hint="Press 'End the driver' first.")
        await self._programs.start(name)
        return {"started": name}

    async def _stop(self, request: Request, _file: Path) -> Reply:
        name = str(request.get("what"))
        if name == "driver":  # whoever has started it
            answer = await asyncio.to_thread(ask, "stop")
            return {"saved": str(answer.get("text"))}
        await self._programs.stop(name)
        return {"stopped": name}

    async def _answer(self, request: Request, _file: Path) -> Reply:
        self._programs.answer(str(request.get("what")), str(request.get("text"))[:80])
        return {}

    async def _list_outputs(self, _request: Request, file: Path) -> Reply:
        def look() -> Any:
            whole = check_profile(file).whole if file.is_file() else None
            return list_outputs(whole if isinstance(whole, Profile) else None)

        return {"outputs": await asyncio.to_thread(look)}

    async def _list_profiles(self, _request: Request, _file: Path) -> Reply:
        return {"profiles": await asyncio.to_thread(_describe_profiles)}

    async def _take_picture(self, _request: Request, _file: Path) -> Reply:
        return {"picture": await asyncio.to_thread(take_picture)}

    async def _let_in(self, _request: Request, _file: Path) -> Reply:
        """Serves the page to other devices, from a process of its own, until it is stopped."""
        if self._is_far:
            raise PageError("Only the machine itself may let in another device.")
        address = _find_own_address()
        self._token = make_token()
        path = find_runtime_folder() / _REMOTE_FILE
        path.parent.mkdir(mode=0o700, exist_ok=True)
        path.unlink(missing_ok=True)
        path.touch(mode=0o600)
        path.write_text(self._token)
        command = ("view", "--edit", "--listen", address, "--token-file", str(path))
        await self._programs.start("remote", *command)
        self._expiry = asyncio.get_running_loop().call_later(self._remote_s, self._end_remote)
        return {"started": "remote"}

    def _end_remote(self) -> None:
        self._ending = asyncio.create_task(self._programs.stop("remote"))

    def _hear_program(self, news: Reply) -> None:
        """Passes on what a program says; of a remote, the link to photograph."""
        if news["name"] != "remote":
            self._tell_all({"program": news})
        elif "code" in news:
            if self._expiry is not None:
                self._expiry.cancel()  # the next phone has an hour of its own
            self._remote = None
            self._tell_all({"remote": None})
        elif news["line"].startswith(("Error: ", "Fix: ")):
            self._tell_all({"refused": news["line"]})
        elif found := _FAR_LINK.search(news["line"]):
            (find_runtime_folder() / _REMOTE_FILE).unlink(missing_ok=True)  # it has been read
            link = f"{found[1]}#k={self._token}"
            self._remote = {"link": link, "code": draw_code(link), "minutes": self._remote_s / 60}
            self._tell_all({"remote": self._remote})


def _take_name(name: str) -> str:
    """Returns a name of the list of profiles; a browser names no path.

    Raises:
        ProfileError: it is none.
    """
    if name not in list_profiles():
        raise ProfileError("There is no such profile.")
    return name


def _describe_profiles() -> list[Reply]:
    favourites, own = load_usable_user().slots, find_user_folder()
    rows = []
    for name, path in list_profiles().items():
        written = check_profile(path).written
        rows.append(
            {
                "name": name,
                "own": path.parent == own,
                "first": name == favourites[0],
                "about": "It has errors." if written is None else written.description,
                "broken": written is None,
            }
        )
    return rows


def _find_own_address() -> str:
    """Returns the address that other devices of this network reach this machine at.

    Raises:
        PageError: it is in no network.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asker:
        try:
            asker.connect(("192.0.2.1", 9))  # sends nothing: the kernel only chooses the way
        except OSError:
            raise PageError(
                "This machine is in no network.", hint="Connect it to the phone's Wi-Fi."
            ) from None
        return str(asker.getsockname()[0])
