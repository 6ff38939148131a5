"""Carries out the requests of browsers."""

import asyncio
import re
import socket
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any, Final

from neurotouch_hid.client import ask, ask_every, get_text, is_served, wait_until_ended
from neurotouch_hid.errors import PageError, ProfileError
from neurotouch_hid.files.faults import describe_fault
from neurotouch_hid.page.address import write_secret
from neurotouch_hid.page.browser import Browser
from neurotouch_hid.page.edits import Changes, Wish
from neurotouch_hid.page.guard import make_token
from neurotouch_hid.page.messages import PageMessage, ProfileRow, ProgramNews, Remote
from neurotouch_hid.page.output_choices import OutputGroup, list_outputs
from neurotouch_hid.page.own_values import OwnValues, load_usable_user
from neurotouch_hid.page.pictures import draw_code, take_picture
from neurotouch_hid.page.profile_view import ProfileFault, ProfileView, describe_profile
from neurotouch_hid.page.programs import DRIVERS, Programs
from neurotouch_hid.page.reading import read_word
from neurotouch_hid.page.situation import MENDS
from neurotouch_hid.players import find_player, find_runtime_folder
from neurotouch_hid.profile import Profile, check_profile, list_profiles
from neurotouch_hid.profile.reading import Checked, check_listed, find_user_folder
from neurotouch_hid.program_pause import ProgramPause

Request = dict[str, Any]
"""The message of a browser, which may hold anything: each value is checked where it is read."""

Reply = PageMessage
Handler = Callable[[Request], Awaitable[Reply]]

REMOTE_S: Final = 3600.0
"""The access of another device to this page ends after this time."""

_REMOTE_FILE: Final = "remote-token"
_FAR_LINK = re.compile(r"From other machines: (\S+)#k=TOKEN")


class Requests:
    """Carries out the requests of browsers.

    Args:
        edit: True if changes are allowed.
        is_far: the page is served to other machines, and may not admit more of them.
        changes: saves changes to profiles.
        own: saves changes to the person's own values.
        tell_all: sends a message to every browser.
    """

    def __init__(
        self,
        *,
        edit: bool,
        is_far: bool,
        changes: Changes,
        own: OwnValues,
        tell_all: Callable[[Reply], object],
    ) -> None:
        self._edit, self._is_far = edit, is_far
        self._tell_all = tell_all
        self._programs = Programs(self._hear_program)
        self._token = ""
        self._remote: Remote | None = None
        self._expiry: asyncio.TimerHandle | None = None
        self._looks: dict[str, Callable[[Request, Path], Reply]] = {
            "outputs": lambda _, file: {"outputs": _list_outputs(file)},
            "profiles": lambda _request, _file: {"profiles": _describe_profiles()},
            "profile": lambda request, _: _show_profile(_read_name(request)),
            "stop keys": lambda _request, _file: {"stop_keys": _find_stop_keys()},
            "picture": lambda _request, _file: {"picture": take_picture()},
        }
        self._savers: dict[str, Callable[[Request, Path], str]] = {
            "set": lambda request, file: changes.set(
                file, read_word(request, "key"), read_word(request, "mark"), request.get("value")
            ),
            "undo": lambda _, file: changes.undo(file),
            "bind": lambda request, file: changes.bind(file, _read_wish(request)),
            "unbind": lambda request, file: changes.unbind(file, read_word(request, "key")),
            "use": lambda request, _: changes.use(_read_name(request)),
            "copy": lambda request, _: changes.copy(_read_name(request)),
            "own value": lambda request, _: own.set(
                read_word(request, "name"), read_word(request, "value")
            ),
            "undo own values": lambda *_: own.undo(),
            "undo calibration": lambda *_: own.undo_calibration(),
            "mend own values": lambda *_: own.mend(),
        }
        self._handlers: dict[str, Handler] = {
            "pause": self._command,
            "resume": self._command,
            "start": self._start,
            "stop": self._stop,
            "answer": self._answer,
            "remote": self._let_in,
        }

    @property
    def news(self) -> list[Reply]:
        """The messages for a browser that connects later."""
        news: list[Reply] = [{"program": each} for each in self._programs.news]
        return news if self._remote is None else [*news, {"remote": self._remote}]

    async def carry_out(self, request: Request, file: Path) -> Reply:
        """Returns the answer to a request.

        Args:
            request: the request; ``do`` is its kind.
            file: the active profile.

        Raises:
            NeuroTouchError: the request fails or is not allowed.
        """
        verb = read_word(request, "do", "")
        if verb in self._looks:
            return await asyncio.to_thread(self._looks[verb], request, file)
        if verb not in self._savers and verb not in self._handlers:
            raise PageError("There is no such request.")
        self._require_edit()
        if verb in self._savers:
            return {"saved": await asyncio.to_thread(self._savers[verb], request, file)}
        return await self._handlers[verb](request)

    async def pause_for_movement(self, browser: Browser, verb: object) -> Reply:
        """Pauses the driver while a browser waits for a movement, or ends that.

        Raises:
            NeuroTouchError: no driver can be paused, or the page may not.
        """
        self._require_edit()
        await asyncio.to_thread(browser.end_pause)
        if verb == "pause":
            browser.pause = await asyncio.to_thread(ProgramPause)
        return {"saved": ""}

    def _require_edit(self) -> None:
        if not self._edit:
            raise PageError(
                "This page is read-only.", hint="To change things: neurotouch view --edit"
            )

    async def close(self) -> None:
        """Ends all programs that it has started."""
        await self._programs.close()

    async def _command(self, request: Request) -> Reply:
        """Pauses or resumes every driver of this player: the page shows the nearest one only."""
        reached = await asyncio.to_thread(ask_every, request["do"], [find_player()])
        for each in reached:
            if each.error is not None:
                raise each.error
        # The next state says what is done, beside the button that takes it back.
        return {"saved": "" if reached[0].is_done else reached[0].text}

    async def _start(self, request: Request) -> Reply:
        name = read_word(request, "what")
        if name == "remote":
            raise PageError("There is no such program.")
        if name in MENDS.values() and self._is_far:
            raise PageError("Only the machine itself may ask for its password.")
        if name in DRIVERS and await asyncio.to_thread(is_served, find_runtime_folder()):
            if request.get("instead") is not True:
                hint = "Press 'End the driver' first."
                raise PageError("A driver of yours runs already.", hint=hint)
            await asyncio.to_thread(ask, "stop")
            await asyncio.to_thread(wait_until_ended, find_runtime_folder())
        await self._programs.start(name)
        return {"started": name}

    async def _stop(self, request: Request) -> Reply:
        name = read_word(request, "what")
        if name == "driver":  # started from here or elsewhere
            answer = await asyncio.to_thread(ask, "stop")
            return {"saved": get_text(answer)}
        await self._programs.stop(name)
        return {"stopped": name}

    async def _answer(self, request: Request) -> Reply:
        self._programs.answer(read_word(request, "what"), read_word(request, "text"))
        return {}

    async def _let_in(self, _request: Request) -> Reply:
        """Serves the page to other devices, from a separate process, until it is stopped."""
        if self._is_far:
            raise PageError("Only the machine itself can give access to another device.")
        address = _find_own_address()
        self._token = make_token()
        try:
            path = write_secret(_REMOTE_FILE, self._token)
        except OSError as error:
            raise PageError(f"The secret cannot be kept: {error.strerror}.") from error
        command = ("view", "--edit", "--listen", address, "--token-file", str(path))
        await self._programs.start("remote", *command)
        self._expiry = asyncio.get_running_loop().call_later(REMOTE_S, self._end_remote)
        return {"started": "remote"}

    def _end_remote(self) -> None:
        self._ending = asyncio.create_task(self._programs.stop("remote"))

    def _hear_program(self, news: ProgramNews) -> None:
        """Forwards the output of a program; of a remote page, its link as a QR code."""
        if news["name"] != "remote":
            self._tell_all({"program": news})
        elif "line" not in news:
            if self._expiry is not None:
                self._expiry.cancel()  # the next phone has an hour of its own
            self._remote = None
            self._tell_all({"remote": None})
        elif news["line"].startswith(("Error: ", "Fix: ")):
            self._tell_all({"refused": news["line"]})
        elif found := _FAR_LINK.search(news["line"]):
            (find_runtime_folder() / _REMOTE_FILE).unlink(missing_ok=True)  # it has been read
            link = f"{found[1]}#k={self._token}"
            self._remote = {"link": link, "code": draw_code(link), "minutes": REMOTE_S / 60}
            self._tell_all({"remote": self._remote})


def _read_name(request: Request) -> str:
    """Returns the profile of a request; a browser cannot name a path.

    Raises:
        ProfileError: it is not in the list of profiles.
    """
    name = read_word(request, "profile")
    if name not in list_profiles():
        raise ProfileError("There is no such profile.")
    return name


def _read_wish(request: Request) -> Wish:
    parts = ("movement", "press", "mode", "do_this", "layer", "instead")
    return Wish(*(read_word(request, part, "") for part in parts))


def _list_outputs(file: Path) -> list[OutputGroup]:
    whole = check_profile(file).whole if file.is_file() else None
    return list_outputs(whole if isinstance(whole, Profile) else None)


def _show_profile(name: str) -> Reply:
    """Returns any profile of the list, which need not be the active one."""
    return {"shown": _describe_profile(list_profiles()[name]), "name": name}


def _describe_profile(path: Path) -> ProfileView | ProfileFault:
    """Returns a profile to look at: only the active one can be changed."""
    try:
        return describe_profile(path.resolve(), edit=False)
    except ProfileError as error:
        return {"fault": error.message, "can_undo": False}


def _find_stop_keys() -> dict[str, str]:
    """Returns the keys that stop a driver of this person, in words.

    Raises:
        ProfileError: the driver's settings cannot be read.
    """
    # Imports numpy, which the page needs for nothing else.
    from neurotouch_hid.driver.settings import load_driver_settings  # noqa: PLC0415

    chords = load_driver_settings().chords
    return {
        name: " + ".join(key.replace("_", " ").capitalize() for key in chord.split("+"))
        for name, chord in (("pause", chords.pause), ("panic", chords.panic))
    }


def _describe_profiles() -> list[ProfileRow]:
    favourites, own = load_usable_user().slots, find_user_folder()
    rows: list[ProfileRow] = []
    for name, path in list_profiles().items():
        checked = check_listed(path)
        whole = checked.whole
        rows.append(
            {
                "name": name,
                "own": path.parent == own,
                "first": name == favourites[0],
                "about": _explain_faults(checked) if whole is None else whole.description,
                "broken": whole is None,
            }
        )
    return rows


def _explain_faults(checked: Checked[Profile]) -> str:
    """Returns how many errors a profile has, and the first of them."""
    errors = [fault for fault in checked.faults if fault.severity == "error"]
    begin = "It has an error." if len(errors) == 1 else f"It has {len(errors)} errors. The first:"
    return f"{begin} {describe_fault(errors[0])}"


def _find_own_address() -> str:
    """Returns the address of this machine in its network.

    Raises:
        PageError: it is not in a network.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asker:
        try:
            asker.connect(("192.0.2.1", 9))  # sends nothing: the kernel only chooses the way
        except OSError:
            raise PageError(
                "This machine is not connected to a network.",
                hint="Connect it to the phone's Wi-Fi.",
            ) from None
        return str(asker.getsockname()[0])
