"""What belongs to the driver on this machine: profiles of applications, chords of the keyboard."""

from pathlib import Path
from typing import Annotated, Final

from pydantic import AfterValidator, Field

from neurotouch_hid.profile.keys import parse_chord
from neurotouch_hid.profile.library import NAME_PATTERN, find_user_file
from neurotouch_hid.profile.load import load_settings
from neurotouch_hid.profile.schema import check_version
from neurotouch_hid.profile.strict import Strict

FILE: Final = "driver.yaml"


def _check_chord(text: str) -> str:
    parse_chord(text)
    return text


Chord = Annotated[str, AfterValidator(_check_chord)]


class Application(Strict):
    """The profile of one application."""

    window: Annotated[str, Field(min_length=1, max_length=128)] = Field(
        description="What its windows are called: under X11 the class (xprop WM_CLASS), under "
        "Wayland the app_id; 'neurotouch status' shows it. Case does not count. No default."
    )
    profile: Annotated[str, Field(pattern=NAME_PATTERN)] = Field(
        description="The profile that holds while it is in front. No default."
    )


class Chords(Strict):
    """The keys that stop everything while they are down together."""

    panic: Chord = Field(
        default="backspace+escape+enter",
        description="Stop everything until 'neurotouch resume'. Default: backspace+escape+enter.",
    )
    pause: Chord = Field(
        default="backspace+escape+space",
        description="Pause, and the same again: go on. Default: backspace+escape+space.",
    )


class DriverSettings(Strict):
    """The file ``driver.yaml`` beside the person's own values."""

    version: Annotated[int, AfterValidator(check_version)] = Field(
        default=1,
        description="The version of this format: 1. Default: 1.",
        json_schema_extra={"const": 1},
    )
    applications: Annotated[list[Application], Field(max_length=256)] = Field(
        default=[], description="Applications with a profile of their own. Default: none."
    )
    chords: Chords = Field(
        default_factory=Chords, description="The keyboard's way to stop. Default: see there."
    )

    @property
    def profile_of(self) -> dict[str, str]:
        """The profile of each application; of two for the same window, the first."""
        return {each.window: each.profile for each in reversed(self.applications)}

    @property
    def keys_of(self) -> dict[str, tuple[str, ...]]:
        """The keys of each chord, by the kernel's names."""
        return {"panic": parse_chord(self.chords.panic), "pause": parse_chord(self.chords.pause)}


def find_driver_file() -> Path:
    """The file of these settings; it need not exist."""
    return find_user_file().with_name(FILE)


def load_driver_settings() -> DriverSettings:
    """The settings; the defaults if there is no file.

    Raises:
        ProfileError: the file says something we cannot do; every mistake has line and column.
    """
    return load_settings(find_driver_file(), DriverSettings)
