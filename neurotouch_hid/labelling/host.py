"""Talks with the browsers in which a person labels: one sheet, saved after every change."""

import asyncio
import base64
from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import partial
from typing import Any, Final

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.ipc import read_object
from neurotouch_hid.labelling.agreement import find_differences, measure_agreement
from neurotouch_hid.labelling.doubts import find_doubts
from neurotouch_hid.labelling.label_file import LabelFile
from neurotouch_hid.labelling.look_through import Moments
from neurotouch_hid.labelling.sheet import Sheet
from neurotouch_hid.labelling.track import UNLABELLED, Track
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX, GestureKind
from neurotouch_hid.page.browser import Browser
from neurotouch_hid.page.reading import read_number

PAGES: Final = {"/": "/label/label.html"}
_KINDS: Final = {kind.label: kind for kind in GestureKind}
_WITHOUT: Final = "-"


class LabelHost:
    """Serves one recording to label.

    Args:
        moments: the recording.
        file: where the labels are saved.
        name: of the recording, for the page.
        other: another person's labels, to compare with; None without.
        other_name: that person's name.

    Attributes:
        sheet: the labels.

    Raises:
        RecordingError: the file of labels is wrong.
    """

    def __init__(
        self,
        moments: Moments,
        file: LabelFile,
        *,
        name: str,
        other: Track | None = None,
        other_name: str = "",
    ) -> None:
        self.sheet = Sheet(moments)
        self.sheet.labels.put(0, file.read())
        self._moments, self._file, self._name = moments, file, name
        self._other, self._other_name = other, other_name
        self._doubts = [[doubt.moment, doubt.reason] for doubt in find_doubts(moments)]
        self._browsers: set[Browser] = set()
        self._turn = asyncio.Lock()

    @property
    def n_browsers(self) -> int:
        """The number of browsers."""
        return len(self._browsers)

    async def run(self) -> None:
        """Does nothing: all that happens is asked for."""

    async def close(self) -> None:
        """Does nothing: every change is saved already."""

    async def serve(self, browser: Browser, hz: int) -> None:  # noqa: ARG002  # nothing is streamed
        """Talks with a browser, until it disconnects."""
        self._browsers.add(browser)
        try:
            browser.queue_message({"hello": True, "recording": self._describe()})
            browser.queue_message({"sheet": self._describe_sheet()})
            await browser.talk(partial(self._hear, browser))
        finally:
            self._browsers.discard(browser)

    async def _hear(self, browser: Browser, message: str | bytes) -> None:
        request = read_object(message)
        if request is None:
            browser.queue_message({"refused": "The message cannot be read."})
            return
        n = request.get("n")
        try:
            if request.get("do") == "show":
                browser.queue_message({"moment": self._describe_moment(self._read_moment(request))})
                return
            async with self._turn:
                about = self._read_change(request)()
                sheet = self._describe_sheet()
                try:
                    labels = self.sheet.labels.part(0, len(self._moments) - 1)
                    await asyncio.to_thread(self._file.write, labels)
                finally:
                    for each in self._browsers:
                        each.queue_message({"sheet": sheet})
            browser.queue_message({"saved": f"{about}.", "n": n})
        except NeuroTouchError as error:
            hint = f" {error.hint}" if error.hint else ""
            browser.queue_message({"refused": f"{error.message}{hint}", "n": n})

    def _read_change(self, request: Mapping[str, Any]) -> Callable[[], str]:
        """Returns what changes the sheet as a page asks, and says what was done."""
        sheet = self.sheet
        readers: dict[Any, Callable[[], Callable[[], str]]] = {
            "confirm": lambda: partial(sheet.accept, *_read_range(request)),
            "confirm_rest": lambda: sheet.accept_rest,
            "type": lambda: partial(sheet.set_kind, *_read_range(request), _read_kind(request)),
            "clear": lambda: partial(sheet.clear, *_read_range(request)),
            "move": lambda: partial(
                sheet.move_contact, *self._read_contact(request), *_read_place(request)
            ),
            "add": lambda: partial(
                sheet.add_contact, self._read_moment(request), *_read_place(request)
            ),
            "remove": lambda: partial(sheet.remove_contact, *self._read_contact(request)),
            "undo": lambda: sheet.undo,
            "redo": lambda: sheet.redo,
        }
        try:
            return readers[request.get("do")]()
        except (KeyError, TypeError, ValueError, OverflowError):
            raise NeuroTouchError("The page asks for something unknown. Load it again.") from None

    def _read_contact(self, request: Mapping[str, Any]) -> tuple[int, int]:
        return self._read_moment(request), _read_whole(request["index"])

    def _read_moment(self, request: Mapping[str, Any]) -> int:
        try:
            k = _read_whole(request["k"])
        except (KeyError, ValueError):
            k = -1
        if not 0 <= k < len(self._moments):
            raise NeuroTouchError("There is no such moment.")
        return k

    def _describe(self) -> dict[str, Any]:
        moments = self._moments
        return {
            "name": self._name,
            "file": self._file.path.name,
            "simulated": moments.is_simulated,
            "other": self._other_name,
            "times_ms": [int(t_us - moments.t_us[0]) // 1000 for t_us in moments.t_us],
            "proposals": _write_kinds(moments.proposals),
            "proposed_counts": _write_counts(moments.proposals),
            "others": None if self._other is None else _write_kinds(self._other),
            "doubts": self._doubts,
            "kinds": list(_KINDS),
        }

    def _describe_sheet(self) -> dict[str, Any]:
        labels = self.sheet.labels
        described: dict[str, Any] = {
            "kinds": _write_kinds(labels),
            "counts": _write_counts(labels),
            "can_undo": self.sheet.can_undo,
            "can_redo": self.sheet.can_redo,
        }
        if self._other is not None:
            agreement = measure_agreement(labels, self._other, self._moments.px_per_mm)
            described["agreement"] = None if agreement is None else asdict(agreement)
            described["differences"] = [
                (run.first + run.last) // 2 for run in find_differences(labels, self._other)
            ]
        return described

    def _describe_moment(self, k: int) -> dict[str, Any]:
        moments = self._moments
        picture = int(moments.picture[k])
        content = base64.b64encode(moments.pictures.read(picture)).decode() if picture >= 0 else ""
        return {
            "k": k,
            "picture": f"data:image/jpeg;base64,{content}" if content else "",
            "dots": [
                [round(float(x), 1), round(float(y), 1), int(seen)]
                for (x, y), seen in zip(moments.markers_px[k], moments.is_seen[k], strict=True)
                if x == x  # noqa: PLR0124  # not NaN
            ],
            "proposal": _describe_label(moments.proposals, k),
            "label": _describe_label(self.sheet.labels, k),
            "other": None if self._other is None else _describe_label(self._other, k),
        }


def _describe_label(track: Track, k: int) -> dict[str, Any] | None:
    if track.kind[k] == UNLABELLED:
        return None
    return {
        "kind": GestureKind(int(track.kind[k])).label,
        "intensity_mm": round(float(track.intensity_mm[k]), 2),
        "contacts": [[round(float(x), 1), round(float(y), 1)] for x, y in track.points(k)],
    }


def _write_kinds(track: Track) -> str:
    return "".join(_WITHOUT if kind == UNLABELLED else str(kind) for kind in track.kind)


def _write_counts(track: Track) -> str:
    return "".join(map(str, track.counts))


def _read_range(request: Mapping[str, Any]) -> tuple[int, int]:
    return _read_whole(request["first"]), _read_whole(request["last"])


def _read_kind(request: Mapping[str, Any]) -> GestureKind:
    return _KINDS[request["kind"]]


def _read_whole(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(value)
    return value


def _read_place(request: Mapping[str, Any]) -> tuple[float, float]:
    """Returns a place in or near the picture."""
    x, y = read_number(request["x"]), read_number(request["y"])
    for value, limit in ((x, SENSOR_WIDTH_PX), (y, SENSOR_HEIGHT_PX)):
        if not -limit <= value <= 2 * limit:  # as in a file of labels
            raise ValueError(value)
    return x, y
