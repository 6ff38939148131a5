"""Forwards the driver's newest state to each browser, as fast as the browser can take it."""

import asyncio
import time
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from neurotouch_hid.driver_state import read_head
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.files.small_file import find_real_path
from neurotouch_hid.files.stamps import Stamp, read_stamps
from neurotouch_hid.ipc import HAND, connect_to, read_object
from neurotouch_hid.page.browser import Browser
from neurotouch_hid.page.edits import Changes
from neurotouch_hid.page.messages import PageMessage, SituationState
from neurotouch_hid.page.own_values import (
    OwnValues,
    OwnValuesView,
    describe_own,
    find_unfinished_files,
    load_usable_user,
)
from neurotouch_hid.page.profile_view import (
    ProfileFault,
    ProfileView,
    can_undo,
    describe_profile,
    list_files,
)
from neurotouch_hid.page.reading import read_number
from neurotouch_hid.page.requests import Requests
from neurotouch_hid.page.situation import StartName, find_situation, find_start
from neurotouch_hid.players import find_runtime_folder, find_user_file
from neurotouch_hid.profile.reading import find_profile
from neurotouch_hid.subscriber import MOST_HZ, Subscriber

if TYPE_CHECKING:
    from neurotouch_hid.evaluation.people.throughput import Figures

LOOK_S: Final = 0.5
"""Interval at which it looks for a driver, and for changes of the profile's file."""

SILENT_S: Final = 3.0
"""A driver that has sent no state for this time waits for its camera."""

MOST_TRIALS: Final = 500


class Hub:
    """All browsers of a server, and the one driver that they watch.

    Args:
        edit: True if browsers may change, pause or start anything.
        stamp: returns the present time, for the names of versions.
        is_far: the page is served to other machines too.
    """

    def __init__(self, *, edit: bool, stamp: Any, is_far: bool = False) -> None:
        self._edit, self._is_far = edit, is_far
        self._requests = Requests(
            edit=edit,
            is_far=is_far,
            changes=Changes(stamp),
            own=OwnValues(stamp),
            tell_all=self._tell_all,
        )
        self._situation: SituationState | None = None
        self._plugged: StartName = ""
        self._listener = Subscriber()
        self._browsers: set[Browser] = set()
        self._came = asyncio.Event()  # a browser, which waits for nothing
        self._path = Path()
        self._stamps: tuple[Any, ...] = ()
        self._own_stamps: dict[Path, Stamp] | None = None
        self._about: ProfileView | ProfileFault | None = None
        self._own: OwnValuesView = {}
        self._hand: Any = None
        self._newest: bytes | None = None
        self._heard_s = 0.0

    @property
    def n_browsers(self) -> int:
        """The number of browsers."""
        return len(self._browsers)

    async def run(self) -> None:
        """Connects to a driver, and to the next one when it has ended; never returns."""
        while True:
            if self._browsers:
                self._connect()
                self._look_at_profile()
                await self._look_around()
            elif self._listener.peer is not None:
                asyncio.get_running_loop().remove_reader(self._listener.peer.fileno())
                self._listener.close()
                self._newest = None
            self._came.clear()
            with suppress(TimeoutError):
                await asyncio.wait_for(self._came.wait(), LOOK_S)

    async def _look_around(self) -> None:
        """Tells the browsers what to do next, while no driver runs or nothing comes from it."""
        runs = self._listener.peer is not None
        if runs and (time.monotonic() - self._heard_s < SILENT_S or not self._wanted_hz):
            if self._newest is not None:
                self._situation = None
                await self._look_for_camera(self._newest)
            return
        situation = await asyncio.to_thread(find_situation, waits=runs)
        found: SituationState = {
            "kind": situation.kind,
            "text": situation.text,
            "next": situation.next,
            "mend": situation.mend,
            "start": situation.start,
        }
        if found != self._situation:
            self._situation = found
            self._tell_all({"situation": found})

    async def _look_for_camera(self, state: bytes) -> None:
        """Tells the browsers of a camera that could play in place of a simulated gel."""
        is_simulated = bool(read_head(state)["slow"].get("simulated"))
        plugged: StartName = await asyncio.to_thread(find_start) if is_simulated else ""
        if plugged != self._plugged:
            self._plugged = plugged
            self._tell_all({"plugged": plugged})

    def _tell_all(self, message: PageMessage) -> None:
        for browser in self._browsers:
            browser.tell(**message)

    def _connect(self) -> None:
        """Looks for a driver, and for the person's own one while the service is watched."""
        before = self._listener.peer
        descriptor = -1 if before is None else before.fileno()
        peer = self._listener.connect()
        if peer is None or peer is before:
            return
        loop = asyncio.get_running_loop()
        if before is not None:
            self._forget_driver(descriptor)
        loop.add_reader(peer.fileno(), self._receive, peer.fileno())
        self._heard_s = time.monotonic()
        for browser in self._browsers:
            browser.tell(driver=True)

    def _forget_driver(self, descriptor: int) -> None:
        asyncio.get_running_loop().remove_reader(descriptor)
        self._newest = None
        for browser in self._browsers:
            browser.end_states()
            browser.tell(driver=False)

    async def serve(self, browser: Browser, hz: int) -> None:
        """Serves a browser that has sent the token, until it disconnects."""
        self._look_at_profile()  # for the other browsers; this one gets the profile below
        self._browsers.add(browser)
        self._came.set()
        try:
            browser.hz = min(max(hz, 0), MOST_HZ)
            self._connect()
            self._set_rate()
            runs = self._listener.peer is not None
            browser.tell(hello=True, edit=self._edit, far=self._is_far, driver=runs)
            if self._about is not None:
                browser.tell(about=self._about)
            browser.tell(own=self._own)
            if self._situation is not None:
                browser.tell(situation=self._situation)
            if self._plugged:
                browser.tell(plugged=self._plugged)
            for news in self._requests.news:
                browser.tell(**news)
            await browser.talk(partial(self._hear, browser))
        finally:
            self._browsers.discard(browser)
            await asyncio.to_thread(browser.end_pause)
            self._set_rate()

    async def close(self) -> None:
        """Disconnects from the driver, and ends the programs that the page has started."""
        await self._requests.close()
        self._listener.close()
        if self._hand is not None:
            self._hand.close()

    @property
    def _wanted_hz(self) -> int:
        return max((browser.hz for browser in self._browsers), default=0)

    def _set_rate(self) -> None:
        if not self._listener.hz:  # nothing was asked for until now
            self._heard_s = time.monotonic()
        self._listener.want(self._wanted_hz)

    def _receive(self, descriptor: int) -> None:
        state = self._listener.take()
        if self._listener.peer is None:  # the driver has ended
            self._forget_driver(descriptor)
            return
        if state is None:
            return
        self._heard_s = time.monotonic()
        for browser in self._browsers:
            browser.queue_state(state)
        is_first, self._newest = self._newest is None, state
        if is_first:
            self._look_at_profile()

    def _look_at_profile(self) -> None:
        """Tells the browsers of the active profile, if it or its file has changed."""
        self._look_at_own()
        runs = self._newest is not None
        file = "" if self._newest is None else str(read_head(self._newest)["slow"]["file"])
        path = Path(file or _find_favourite())
        stamps = (path, runs, read_stamps(list_files(path)))
        if stamps == self._stamps:
            return
        self._path = path
        self._stamps = stamps
        self._about = None
        if path.name:
            try:
                self._about = describe_profile(path, edit=self._edit)
            except NeuroTouchError as error:
                can = self._edit and can_undo(path)
                self._about = {"fault": error.message, "can_undo": can}
        for browser in self._browsers:
            browser.tell(about=self._about, driver=runs)

    def _look_at_own(self) -> None:
        """Tells the browsers of the person's own values, if they have changed."""
        stamps = read_stamps([find_user_file(), *find_unfinished_files()])
        if stamps == self._own_stamps:
            return
        self._own_stamps = stamps
        self._own = describe_own()
        for browser in self._browsers:
            browser.tell(own=self._own)

    async def _hear(self, browser: Browser, message: str | bytes) -> None:
        """Carries out a browser's request; reports refused ones to the browser."""
        request = read_object(message)
        if request is None:
            browser.tell(refused="The message cannot be read.")
            return
        number = request.get("n")
        n = number if isinstance(number, int) else None
        try:
            match request.get("do"):
                case "rate" if isinstance(request.get("hz"), int):
                    browser.hz = min(max(request["hz"], 0), MOST_HZ)
                    self._set_rate()
                case "hand":
                    self._steer(message if isinstance(message, bytes) else message.encode())
                case "throughput":
                    figures = await asyncio.to_thread(_measure, request.get("trials"))
                    browser.tell(throughput=figures, n=n)
                case "pause" | "resume" as verb if request.get("for") == "movement":
                    reply = await self._requests.pause_for_movement(browser, verb)
                    answer: PageMessage = {**reply, "n": n}
                    browser.tell(**answer)
                case _:
                    reply = await self._requests.carry_out(request, self._path)
                    answer = {**reply, "n": n}
                    self._look_at_profile()  # first: what is said to be saved is shown already
                    browser.tell(**answer)
        except NeuroTouchError as error:
            hint = f" {error.hint}" if error.hint else ""
            browser.tell(refused=f"{error.message}{hint}", n=n)
            if self._about is not None:
                browser.tell(about=self._about)  # a mark that was dragged goes back
            browser.tell(own=self._own)

    def _steer(self, message: bytes) -> None:
        """Forwards a command of the mouse gel to the simulator, if the simulator is the source.

        If there is no room, the command is dropped: the next one is newer.
        """
        for _ in range(2):
            try:
                if self._hand is None:
                    self._hand = connect_to(find_runtime_folder() / HAND)
                self._hand.send(message)
                return
            except BlockingIOError:
                return
            except OSError:
                if self._hand is None:
                    return
                self._hand.close()
                self._hand = None


def _find_favourite() -> str:
    """Returns the profile that the next driver would use; empty if it is unknown."""
    try:
        return str(find_real_path(find_profile(load_usable_user().slots[0])))
    except (NeuroTouchError, OSError):
        return ""


def _measure(trials: Any) -> "Figures":
    """Returns the figures of ISO 9241-411 for the trials of a game.

    Raises:
        NeuroTouchError: the data is not a list of trials.
    """
    # Imports numpy, which the page needs for nothing else.
    from neurotouch_hid.evaluation.people.throughput import (  # noqa: PLC0415
        Trial,
        measure_pointing,
    )

    if not isinstance(trials, list) or len(trials) > MOST_TRIALS:
        raise NeuroTouchError("There are no trials to measure.")
    try:
        read = [
            Trial(
                read_number(trial["width"]),
                (read_number(trial["start"][0]), read_number(trial["start"][1])),
                (read_number(trial["target"][0]), read_number(trial["target"][1])),
                (read_number(trial["selected"][0]), read_number(trial["selected"][1])),
                read_number(trial["movement_s"]),
            )
            for trial in trials
        ]
        return measure_pointing(read)
    except (KeyError, TypeError, ValueError, IndexError, ZeroDivisionError, OverflowError):
        raise NeuroTouchError("The trials of the game cannot be read.") from None
