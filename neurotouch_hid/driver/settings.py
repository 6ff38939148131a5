"""The settings of the driver on this machine: profiles of applications, chords of the keyboard."""

from pathlib import Path
from typing import Annotated, Final, Literal

from pydantic import AfterValidator, Field
from pydantic_core import PydanticCustomError

from neurotouch_hid.device import is_input_name
from neurotouch_hid.players import find_user_file
from neurotouch_hid.profile.reading import load_settings
from neurotouch_hid.profile.schema import (
    SettingsFile,
    Strict,
    give_unit,
    make_optional,
    parse_chord,
)
from neurotouch_hid.vocabulary import NAME_PATTERN, Button

FILE: Final = "driver.yaml"


def _check_chord(text: str) -> str:
    parse_chord(text)
    return text


def _check_input(name: str) -> str:
    if not is_input_name(name):
        raise PydanticCustomError("key", "the kernel knows no key or button of this name")
    return name


Chord = Annotated[str, AfterValidator(_check_chord)]


class Application(Strict):
    """The profile of one application."""

    window: Annotated[str, Field(min_length=1, max_length=128)] = Field(
        description="What its windows are called: under X11 the class (xprop WM_CLASS), under "
        "Wayland the app_id; 'neurotouch status' shows it. Case does not count. No default."
    )
    profile: Annotated[str, Field(pattern=NAME_PATTERN)] = Field(
        description="The active profile while it is in front. No default."
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


KeyName = Annotated[str, AfterValidator(_check_input)]


class CopilotSettings(Strict):
    """A physical pad, keyboard or switch that plays on the same virtual pad."""

    device: Annotated[str, Field(min_length=1, max_length=128)] | None = Field(
        default=None,
        description="auto for the first gamepad, the path of an event node, or a part of the "
        "name; 'neurotouch devices' shows them. Default: none.",
        json_schema_extra=make_optional(),
    )
    priority: Literal["equal", "gel", "helper"] = Field(
        default="equal",
        description="Who decides about a stick or trigger that both move. equal: who moves it "
        "further. Default: equal.",
    )
    keys: Annotated[dict[KeyName, Annotated[Button, Field(strict=False)]], Field(max_length=64)] = (
        Field(
            default={},
            description="What keys and buttons of the device are, by the kernel's names: "
            "{KEY_SPACE: a}. Default: pads as they are; space and enter are a, escape is b, the "
            "arrows are the D-pad.",
        )
    )


class DriverSettings(SettingsFile):
    """The file ``driver.yaml`` beside the person's own values."""

    applications: Annotated[list[Application], Field(max_length=256)] = Field(
        default=[], description="Applications with a profile of their own. Default: none."
    )
    chords: Chords = Field(
        default_factory=Chords, description="The keyboard's way to stop. Default: see there."
    )

    copilot: CopilotSettings = Field(
        default_factory=CopilotSettings,
        description="A device that plays along. Default: see there.",
    )
    yield_to_mouse_ms: Annotated[int, Field(ge=0, le=10_000)] = Field(
        default=1500,
        description="How long the real mouse must be quiet before the gel moves the pointer, in "
        "ms; 0: it never waits. Default: 1500.",
        json_schema_extra=give_unit("ms"),
    )

    @property
    def profile_of(self) -> dict[str, str]:
        """The profile of each application; of two for the same window, the first."""
        return {each.window: each.profile for each in reversed(self.applications)}

    @property
    def keys_of(self) -> dict[str, tuple[str, ...]]:
        """The keys of each chord, by the kernel's names."""
        return {"panic": parse_chord(self.chords.panic), "pause": parse_chord(self.chords.pause)}


def find_driver_file(player: int | None = None) -> Path:
    """Returns the file of these settings; it need not exist."""
    return find_user_file(player).with_name(FILE)


def load_driver_settings(player: int | None = None) -> DriverSettings:
    """Returns the settings; the defaults if there is no file.

    Args:
        player: the player number; None means the one of the environment.

    Raises:
        ProfileError: the file says something we cannot do; every mistake has line and column.
    """
    return load_settings(find_driver_file(player), DriverSettings)
