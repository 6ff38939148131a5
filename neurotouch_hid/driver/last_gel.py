"""Remembers how the gel is turned in the picture.

A square lattice looks the same after a quarter turn, so the picture alone cannot tell it.
"""

import math
import os
from contextlib import suppress
from pathlib import Path
from typing import Final, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from neurotouch_hid.driver.camera_settings import load_camera_settings
from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_text
from neurotouch_hid.messages import GelState
from neurotouch_hid.partial_file import write_whole
from neurotouch_hid.players import find_player, find_user_file

_SAME_DEG: Final = 1.0
"""A smaller turn is not worth another version of the file."""


class _LastGel(BaseModel):
    """The content of the file."""

    model_config = ConfigDict(extra="forbid", strict=True)

    version: Literal[1] = 1
    rotation_deg: float = Field(ge=-360.0, le=360.0, allow_inf_nan=False)


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
        self._last_deg = _read(self.path)

    @property
    def rotation_rad(self) -> float:
        """The turn to expect: the one in ``camera.yaml``, else the last one, else 0."""
        degrees = self._last_deg if self._chosen_deg is None else self._chosen_deg
        return math.radians(degrees or 0.0)

    def remember(self, gel: GelState) -> None:
        """Writes how the gel lies now, if it is known; a file that cannot be written stays."""
        degrees, before = gel.rotation_deg, self._last_deg
        if degrees is None or (before is not None and abs(degrees - before) < _SAME_DEG):
            return
        with suppress(OSError):
            self.path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(self.path, _LastGel(rotation_deg=degrees).model_dump_json().encode())
            self._last_deg = degrees


def find_last_gel(player: int | None = None) -> Path:
    """Returns the path of the file; it need not exist."""
    state = os.environ.get("STATE_DIRECTORY", "").split(":")[0]
    if state:
        return Path(state) / f"last-gel-{player or find_player()}.json"
    return find_user_file(player).with_name(".last-gel.json")


def _read(path: Path) -> float | None:
    """Returns the last turn in degrees; None if there is none, or the file is damaged."""
    try:
        return _LastGel.model_validate_json(read_text(path, MAX_SETTINGS_BYTES)).rotation_deg
    except (OSError, ValidationError):
        return None
