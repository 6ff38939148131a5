"""A page of the real server, whose driver is played by the test: each message, in its order."""

import json

import numpy as np

from neurotouch_hid.driver_state import MarkerWriter, pack
from neurotouch_hid.gel_sentences import report_gel
from neurotouch_hid.geometry import PAPER_GEL
from neurotouch_hid.messages import GelProblem, GelState, MarkerField
from tests.page.waiting import wait_on

HEALTH = {
    "events_hz": 0,
    "slices_hz": 100,
    "frames_hz": 25.0,
    "lost": 0,
    "backlog_ms": 0.0,
    "tracked": 177,
    "rezero_s": 1.0,
    "window_ms": 10.0,
    "stages": {},
    "source": "sim:mouse",
    "simulated": True,
    "device": "memory",
    "file": "",
}
MARKERS = MarkerWriter().write(
    MarkerField(
        0, *2 * [np.full((PAPER_GEL.n_markers, 2), np.nan, np.float32)], np.zeros(177, bool)
    )
)
FOUND = GelState(is_found=True, was_found=True, problem=GelProblem.NONE, n_seen=177, px_per_mm=2.5)
REST = {
    "n": 1,
    "t_us": 0,
    "say": "At rest",
    "state": "running",
    "profile": "mine",
    "layer": "base",
    "gel": report_gel(FOUND),
    "gesture": {
        "kind": "none",
        "mm": 0.0,
        "movement": "none",
        "felt_mm": 0.0,
        "phase": "idle",
        "contacts": [],
        "confidence": 0.0,
        "moved_mm": [0.0, 0.0],
        "turned_rad": 0.0,
        "scale": 0.0,
    },
    "pad": {"axes": {}, "buttons": [], "keys": [], "mouse": [], "pointer": [0, 0], "wheel": 0.0},
    "actions": [],
    "slow": HEALTH,
}


UNASKED = ("hand", "outputs", "profiles", "profile", "stop keys")
"""What a page sends by itself."""


class PlayedDriver:
    """What the page hears; ``asked`` is what the page has asked for, without the token.

    ``hands`` are the commands of its gel to the simulated hand.
    """

    def __init__(self, page, *, edit: bool = True) -> None:
        self._edit = edit
        self.asked: list[dict] = []
        self.hands: list[dict] = []
        page.route_web_socket("**/stream", self._connect)

    def _connect(self, line) -> None:
        self._line = line
        line.on_message(self._hear)

    def _hear(self, said) -> None:
        message = json.loads(said)
        if "token" in message:
            self.tell(hello=True, edit=self._edit, driver=True)
        elif message["do"] == "hand":
            self.hands.append(message)
        elif message["do"] not in UNASKED:
            self.asked.append(message)

    def tell(self, **message) -> None:
        self._line.send(json.dumps(message))

    def drop(self) -> None:
        """Closes the connection; the page opens another one by itself."""
        self._line.close()

    def show(self, **changes) -> None:
        """Sends a state: the hand at rest, but for the changes."""
        self._line.send(pack({**REST, **changes}, MARKERS))

    def wait_for_request(self, page) -> dict:
        """Returns the oldest request, without its number."""
        wait_on(page, lambda: self.asked)
        request = self.asked.pop(0)
        request.pop("n", None)
        return request

    def answer(self, **message) -> dict:
        """Answers the oldest request, which it returns."""
        request = self.asked.pop(0)
        self.tell(n=request["n"], **message)
        return request
