"""Between the driver and the browsers: the newest state to each as fast as it can take it."""

import asyncio
import json
import time
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final, Literal, TypedDict, Unpack

from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.ipc import HAND, connect_to
from neurotouch_hid.page.edits import Changes
from neurotouch_hid.page.guard import Rate
from neurotouch_hid.page.outputs import OutputGroup
from neurotouch_hid.page.own_values import (
    OwnValues,
    OwnValuesView,
    describe_values,
    load_usable_user,
)
from neurotouch_hid.page.profile_view import ProfileFault, ProfileView, describe_profile
from neurotouch_hid.page.requests import Requests
from neurotouch_hid.page.situation import find_situation
from neurotouch_hid.players import find_runtime_folder, find_user_file
from neurotouch_hid.profile.reading.library import find_profile
from neurotouch_hid.snapshot import read_head
from neurotouch_hid.subscriber import Subscriber

LOOK_S: Final = 0.5
"""How often a driver is looked for, and its profile's file for changes."""

SILENT_S: Final = 3.0
"""A driver that has shown nothing for so long waits for its camera."""

MOST_HZ: Final = 60
MOST_TRIALS: Final = 500


class PageMessage(TypedDict, total=False):
    """What a browser is told beside the states; each message holds some of these keys.

    Attributes:
        hello: the browser may stay.
        edit: the browser may change profiles and pause the driver; comes with ``hello``.
        far: the page is served to other machines; comes with ``hello``.
        driver: a driver runs.
        about: the active profile; while no driver runs, the one it would play.
        own: the person's own values, as far as the page changes them.
        saved: what has been done, in a sentence; empty where the next state says it.
        refused: what has not been done, and why.
        throughput: the figures of a game.
        situation: what keeps the gel from playing while no driver runs.
        outputs: what a movement can do.
        profiles: those there are.
        picture: what the camera sees, as the address of a picture.
        program: output or end of a program that the page has started.
        started: such a program, by name.
        stopped: the same.
        remote: the link for another device; None when its right has ended.
        n: the number of the browser's message that this answers.
    """

    hello: Literal[True]
    edit: bool
    far: bool
    driver: bool
    about: ProfileView | ProfileFault | None
    own: OwnValuesView
    saved: str
    refused: str
    throughput: dict[str, Any]
    situation: dict[str, str]
    outputs: list[OutputGroup]
    profiles: list[dict[str, Any]]
    picture: str
    program: dict[str, Any]
    started: str
    stopped: str
    remote: dict[str, Any] | None
    n: int | None


class Client:
    """A browser. What it has no time for is dropped: only the newest state waits.

    Attributes:
        pauses: the driver is paused for as long as this browser waits for a movement.
    """

    def __init__(self, socket: ServerConnection) -> None:
        self.socket = socket
        self.hz = 0
        self.rate = Rate()
        self.pauses = False
        self._state: bytes | None = None
        self._words: list[str] = []
        self._due_s = 0.0
        self._bell = asyncio.Event()

    def show(self, state: bytes) -> None:
        """Leaves the newest state, if it is time for one."""
        now = time.monotonic()
        if self.hz and now >= self._due_s:
            # A little early is in time, or 30 of 60 would become 20.
            self._due_s = max(self._due_s + 1.0 / self.hz, now - 0.5 / self.hz)
            self._state = state
            self._bell.set()

    def end_states(self) -> None:
        """Drops the state that waits: it is of a driver that has ended."""
        self._state = None

    def tell(self, **message: Unpack[PageMessage]) -> None:
        """Leaves a message; none of these is dropped, and there are few."""
        self._words.append(json.dumps(message, separators=(",", ":")))
        self._bell.set()

    async def send(self) -> None:
        """Sends what is left, until the browser goes."""
        while True:
            await self._bell.wait()
            self._bell.clear()
            words, self._words = self._words, []
            for word in words:
                await self.socket.send(word)
            state, self._state = self._state, None
            if state is not None:
                await self.socket.send(state)


class Hub:
    """All browsers of a server, and the one driver they look at.

    Args:
        edit: whether anything may be changed, paused or started.
        stamp: the present moment, for the names of versions.
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
        self._situation: dict[str, str] | None = None
        self._listener = Subscriber()
        self._clients: set[Client] = set()
        self._came = asyncio.Event()  # a browser, which waits for nothing
        self._path = Path()
        self._stamps: tuple[Any, ...] = ()
        self._about: ProfileView | ProfileFault | None = None
        self._own: OwnValuesView = {}
        self._hand: Any = None
        self._newest: bytes | None = None
        self._heard_s = 0.0

    @property
    def n_clients(self) -> int:
        """How many browsers watch."""
        return len(self._clients)

    async def run(self) -> None:
        """Looks for a driver, and again when that has ended; never returns."""
        while True:
            if self._clients:
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
            return
        found = asdict(await asyncio.to_thread(find_situation, waits=runs))
        if found != self._situation:
            self._situation = found
            self._tell_all({"situation": found})

    def _tell_all(self, message: dict[str, Any]) -> None:
        for client in self._clients:
            client.tell(**message)

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
        for client in self._clients:
            client.tell(driver=True)

    def _forget_driver(self, descriptor: int) -> None:
        asyncio.get_running_loop().remove_reader(descriptor)
        self._newest = None
        for client in self._clients:
            client.end_states()
            client.tell(driver=False)

    async def serve(self, client: Client, hz: int) -> None:
        """Serves a browser that has shown the token, until it goes."""
        self._look_at_profile()  # tells those who are there; this one is told below
        self._clients.add(client)
        self._came.set()
        sender = asyncio.create_task(client.send())
        try:
            client.hz = min(max(hz, 0), MOST_HZ)
            self._connect()
            self._set_rate()
            runs = self._listener.peer is not None
            client.tell(hello=True, edit=self._edit, far=self._is_far, driver=runs)
            if self._about is not None:
                client.tell(about=self._about)
            client.tell(own=self._own)
            if self._situation is not None:
                client.tell(situation=self._situation)
            for news in self._requests.news:
                client.tell(**news)
            async for message in client.socket:
                if not client.rate.allows():
                    await client.socket.close(1008, "too many messages")
                    return
                await self._hear(client, message)
        except ConnectionClosed:
            pass
        finally:
            self._clients.discard(client)
            if client.pauses:  # nobody else goes on
                with suppress(NeuroTouchError):
                    await self._requests.carry_out({"do": "resume"}, self._path)
            self._set_rate()
            sender.cancel()
            with suppress(asyncio.CancelledError, ConnectionClosed):
                await sender

    async def close(self) -> None:
        """Parts from the driver, and ends what the page has started."""
        await self._requests.close()
        self._listener.close()
        if self._hand is not None:
            self._hand.close()

    @property
    def _wanted_hz(self) -> int:
        return max((client.hz for client in self._clients), default=0)

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
        for client in self._clients:
            client.show(state)
        is_first, self._newest = self._newest is None, state
        if is_first:
            self._look_at_profile()

    def _look_at_profile(self) -> None:
        """Tells the browsers of the active profile, if it or its file has changed."""
        runs = self._newest is not None
        file = "" if self._newest is None else str(read_head(self._newest)["slow"]["file"])
        path = Path(file or _find_favourite())
        stamps = (path, runs, _read_stamp(path), _read_stamp(find_user_file()))
        if stamps == self._stamps:
            return
        self._path = path
        self._stamps = stamps
        self._about = None
        if path.name:
            try:
                self._about = describe_profile(path, edit=self._edit)
            except NeuroTouchError as error:
                self._about = {"fault": error.message}
        self._own = describe_values()
        for client in self._clients:
            client.tell(about=self._about, own=self._own, driver=runs)

    async def _hear(self, client: Client, message: str | bytes) -> None:
        """Does what a browser asks for; what it may not ask for, it is told."""
        try:
            request = json.loads(message)
        except (ValueError, RecursionError):
            request = None
        if not isinstance(request, dict):
            client.tell(refused="That is no message.")
            return
        try:
            match request.get("do"):
                case "rate" if isinstance(request.get("hz"), int):
                    client.hz = min(max(request["hz"], 0), MOST_HZ)
                    self._set_rate()
                case "hand":
                    self._steer(message if isinstance(message, bytes) else message.encode())
                case "throughput":
                    client.tell(throughput=await asyncio.to_thread(_measure, request.get("trials")))
                case verb:
                    reply = await self._requests.carry_out(request, self._path)
                    if verb in ("pause", "resume"):
                        client.pauses = verb == "pause" and request.get("for") == "movement"
                    self._look_at_profile()  # first: what is said to be saved is shown already
                    client.tell(**reply, n=request.get("n"))
        except NeuroTouchError as error:
            hint = f" {error.hint}" if error.hint else ""
            client.tell(refused=f"{error.message}{hint}", n=request.get("n"))
            if self._about is not None:
                client.tell(about=self._about)  # a mark that was dragged goes back
            client.tell(own=self._own)

    def _steer(self, message: bytes) -> None:
        """Hands the mouse's gel on to the simulator, if that is what runs; nothing else hears it.

        What has no room is dropped: the next one is newer.
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
    """Returns the profile that the next driver would play; empty if it cannot be said."""
    try:
        return str(find_profile(load_usable_user().slots[0]).resolve())
    except (NeuroTouchError, OSError):
        return ""


def _read_stamp(path: Path) -> tuple[int, ...]:
    with suppress(OSError, ValueError):
        found = path.stat()
        return found.st_ino, found.st_mtime_ns, found.st_size
    return ()


def _measure(trials: Any) -> dict[str, Any]:
    """Returns the figures of ISO 9241-411 for the trials of a game.

    Raises:
        NeuroTouchError: they are none.
    """
    # Imports numpy, which the page needs for nothing else.
    from neurotouch_hid.evaluation.people.throughput import (  # noqa: PLC0415
        Trial,
        measure_pointing,
    )

    if not isinstance(trials, list) or len(trials) > MOST_TRIALS:
        raise NeuroTouchError("There is nothing to measure.")
    try:
        read = [
            Trial(
                float(trial["width"]),
                (float(trial["start"][0]), float(trial["start"][1])),
                (float(trial["target"][0]), float(trial["target"][1])),
                (float(trial["selected"][0]), float(trial["selected"][1])),
                float(trial["movement_s"]),
            )
            for trial in trials
        ]
        return measure_pointing(read)
    except (KeyError, TypeError, ValueError, IndexError, ZeroDivisionError, OverflowError):
        raise NeuroTouchError("These are no trials.") from None
