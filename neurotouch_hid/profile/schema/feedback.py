"""Feedback to the person: the sounds of gestures and actions."""

from typing import Annotated, Any, Literal

from pydantic import Field

from neurotouch_hid.profile.schema.strict import Strict, make_optional

SoundName = Literal["none", "tones", "speech"]

Percent = Annotated[int, Field(ge=0, le=100)]


def _volume(of: str, default: int) -> Any:
    return Field(default=default, description=f"{of}; 0 is silence. Default: {default}.")


class Volumes(Strict):
    """Volume of each class of sounds, in percent of the loudest."""

    press: Percent = _volume("A gesture begins, in percent", 30)
    accept: Percent | None = Field(
        default=None,
        description="A gesture has acted, in percent; 0 is silence. Default: 60, and 0 where "
        "gestures act at once, as in the timing game.",
        json_schema_extra=make_optional(),
    )
    reject: Percent = _volume("A gesture was not accepted, in percent", 60)
    layer: Percent = _volume("Another layer or profile is active, in percent", 60)
    pause: Percent = _volume("Pause, panic and their end, in percent", 80)
    lost: Percent = _volume("The gel is out of sight, found again or has a problem, in percent", 80)


class Feedback(Strict):
    """Feedback to the person, beside the game."""

    sound: SoundName = Field(
        default="none",
        description="none, tones, or speech (through speech-dispatcher). Default: none.",
    )
    volume: Volumes = Field(
        default_factory=Volumes.model_construct,
        description="How loud each class of sounds is. Default: as each says.",
    )
