"""Remembers the gel: its turn in the picture, and its dots that are missing for good.

A square lattice looks the same after a quarter turn, so the picture alone cannot tell it. Missing
dots are remembered so that a person is told of them once, and not at each start.
"""

import hashlib
import math
import os
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Final, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from neurotouch_hid.driver.camera_settings import load_camera_settings
from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_text
from neurotouch_hid.geometry import MOST_MARKERS, Gel
from neurotouch_hid.messages import GelState
from neurotouch_hid.partial_file import write_whole
from neurotouch_hid.players import find_player, find_user_file

_SAME_DEG: Final = 1.0
"""A smaller turn is not worth another version of the file."""

_MOST_GELS: Final = 16
_FORGET_STARTS: Final = 10
"""A dot that was seen at so many starts in a row is missing no more."""

_Dot = Annotated[int, Field(ge=0, lt=MOST_MARKERS)]
_Model = ConfigDict(extra="forbid", strict=True)


class _KnownGel(BaseModel):
    """The missing dots of one gel before one camera.

    Attributes:
        camera: name of the source.
        layout: digest of the places of the dots.
        told: dots that the person has been told of.
        starts: for how many starts each of them has been seen again; 0: it is missing.
        doubtful: dots that were missing at the last start only. Dust is gone at the next one.
    """

    model_config = _Model

    camera: Annotated[str, Field(max_length=500)]
    layout: Annotated[str, Field(max_length=64)]
    told: Annotated[list[_Dot], Field(max_length=MOST_MARKERS)] = []
    starts: Annotated[list[int], Field(max_length=MOST_MARKERS)] = []
    doubtful: Annotated[list[_Dot], Field(max_length=MOST_MARKERS)] = []

    @model_validator(mode="after")
    def _has_starts_of_each(self) -> Self:
        if len(self.told) != len(self.starts):
            raise ValueError("each dot needs its number of starts")
        return self


class _LastGel(BaseModel):
    """The content of the file."""

    model_config = _Model

    version: Literal[1] = 1
    rotation_deg: float | None = Field(default=None, ge=-360.0, le=360.0, allow_inf_nan=False)
    gels: Annotated[list[_KnownGel], Field(max_length=_MOST_GELS)] = []


class LastGel:
    """The gel as the last driver of this camera saw it.

    Args:
        player: the player number; None means the one of the environment.

    Attributes:
        path: the file; a service has it in its folder of state.
    """

    def __init__(self, player: int | None = None) -> None:
        self.path = find_last_gel(player)
        self._chosen_deg = load_camera_settings(player).rotation_deg
        self._last = _read(self.path)

    @property
    def rotation_rad(self) -> float:
        """The turn to expect: the one in ``camera.yaml``, else the last one, else 0."""
        degrees = self._last.rotation_deg if self._chosen_deg is None else self._chosen_deg
        return math.radians(degrees or 0.0)

    def remember(self, gel: GelState) -> None:
        """Writes how the gel lies now, if it is known; a file that cannot be written stays."""
        degrees, before = gel.rotation_deg, self._last.rotation_deg
        if degrees is None or (before is not None and abs(degrees - before) < _SAME_DEG):
            return
        self._write(self._last.model_copy(update={"rotation_deg": degrees}))

    def learn_missing(self, missing: frozenset[int], camera: str, gel: Gel) -> frozenset[int]:
        """Writes which dots are missing at this start, and returns those to tell the person.

        At the first start these are all of them. Later a further dot is told once it is missing at
        two starts in a row: glare and dust are elsewhere at the next one.

        Args:
            missing: the dots, as places in ``Gel.points_mm``.
            camera: name of the source.
            gel: the gel.
        """
        layout = _name_layout(gel)
        known = [each for each in self._last.gels if (each.camera, each.layout) == (camera, layout)]
        others = [each for each in self._last.gels if each not in known]
        if known:
            before = dict(zip(known[0].told, known[0].starts, strict=True))
            unknown = missing - before.keys()
            new = unknown & frozenset(known[0].doubtful)
        else:
            before, unknown, new = {}, missing, missing
        starts = {dot: 0 if dot in missing else n + 1 for dot, n in before.items()}
        starts |= dict.fromkeys(sorted(new), 0)
        told = {dot: n for dot, n in starts.items() if n <= _FORGET_STARTS}
        now = _KnownGel(
            camera=camera[:500],
            layout=layout,
            told=list(told),
            starts=list(told.values()),
            doubtful=sorted(unknown - new),
        )
        if [now] != known:
            gels = [now, *others][:_MOST_GELS]  # the newest first
            self._write(self._last.model_copy(update={"gels": gels}))
        return new

    def _write(self, last: _LastGel) -> None:
        self._last = last
        with suppress(OSError):
            self.path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(self.path, last.model_dump_json().encode())


def find_last_gel(player: int | None = None) -> Path:
    """Returns the path of the file; it need not exist."""
    state = os.environ.get("STATE_DIRECTORY", "").split(":")[0]
    if state:
        return Path(state) / f"last-gel-{player or find_player()}.json"
    return find_user_file(player).with_name(".last-gel.json")


def _name_layout(gel: Gel) -> str:
    """Returns a name that only gels with dots at the same places share."""
    return hashlib.sha256(np.round(gel.points_mm, 3).tobytes()).hexdigest()[:16]


def _read(path: Path) -> _LastGel:
    """Returns what is remembered; nothing if there is no file, or it is damaged."""
    try:
        return _LastGel.model_validate_json(read_text(path, MAX_SETTINGS_BYTES))
    except (OSError, ValidationError):
        return _LastGel()
