"""Model of the user's file: ranges, filter, timing, and the way the gel is mounted."""

from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from neurotouch_hid.profile.schema.feedback import Feedback
from neurotouch_hid.profile.schema.movements import MovementName
from neurotouch_hid.profile.schema.profile import Profile, SettingsFile, make_schema
from neurotouch_hid.profile.schema.strict import Strict, give_unit, make_optional
from neurotouch_hid.profile.schema.timing import FilterName, TimingSetting, resolve_times
from neurotouch_hid.vocabulary import NAME_PATTERN


class MovementRange(Strict):
    """The comfortable range of one movement, as calibration measures it."""

    rest: Annotated[float, Field(ge=0.0, le=5.0)] = Field(
        default=1.0,
        description="Up to here, in mm, it is noise. Default: 1 mm.",
        json_schema_extra=give_unit("mm"),
    )
    full: Annotated[float, Field(ge=1.0, le=18.0)] = Field(
        description="Here, in mm, it counts as a whole movement. No default.",
        json_schema_extra=give_unit("mm"),
    )

    @model_validator(mode="after")
    def _has_extent(self) -> Self:
        if self.full - self.rest < 0.5:
            raise PydanticCustomError(
                "range", "must be at least 0.5 mm above rest", {"at": ("full",)}
            )
        return self


def _range(movement: str) -> Any:
    return Field(
        default=None,
        description=f"The range of {movement}, in mm. Default: that of the reference hand.",
        json_schema_extra=make_optional("mm"),
    )


class Ranges(Strict):
    """The range of each movement; a diagonal push blends the two beside it."""

    push_left: MovementRange | None = _range("a push to the left")
    push_right: MovementRange | None = _range("a push to the right")
    push_up: MovementRange | None = _range("a push away from the user")
    push_down: MovementRange | None = _range("a push towards the user")
    pinch: MovementRange | None = _range("a pinch")
    zoom: MovementRange | None = _range("a zoom")
    twist_cw: MovementRange | None = _range("a clockwise twist")
    twist_ccw: MovementRange | None = _range("a counter-clockwise twist")


class UserSettings(SettingsFile):
    """A person's own values; they apply in every profile and are never exported with one."""

    range: Ranges = Field(
        default_factory=Ranges.model_construct,
        description="How far each movement comfortably goes; profiles count in millimetres of the "
        "reference hand, and this converts. Default: the reference hand.",
    )
    unused: Annotated[list[MovementName], Field(max_length=8)] = Field(
        default=[],
        description="Movements that are not made, as calibration found: what is taken for them "
        "does nothing, profile check warns of bindings that need them, and profile new avoids "
        "them. Default: none.",
    )
    filter: FilterName | None = Field(
        default=None,
        description="The tremor filter: none, light, medium or strong. Default: the timing "
        "preset's, or the profile's.",
        json_schema_extra=make_optional(),
    )
    tremor_hz: Annotated[float, Field(ge=3.0, le=12.0)] | None = Field(
        default=None,
        description="The frequency at which the hand trembles, in Hz: it is taken out before the "
        "tremor filter, and followed as it drifts. Costs about 45 ms. Default: nothing is taken "
        "out.",
        json_schema_extra=make_optional("Hz"),
    )
    timing: TimingSetting | None = Field(
        default=None,
        description="How patient everything is: game, steady, slow, or a preset with changes; "
        "a profile can be slower, never faster. Default: the profile's.",
        json_schema_extra=make_optional(),
    )
    handedness: Literal["right", "left"] = Field(
        default="right",
        description="The hand on the gel; calibration and templates speak of it. Default: right.",
    )
    mirror: bool = Field(
        default=False,
        description="Swap left and right, clockwise and counter-clockwise. Default: false.",
    )
    rotate_deg: Annotated[float, Field(ge=-180.0, le=180.0)] = Field(
        default=0.0,
        description="How far the gel is turned clockwise from where up is away from the user, in "
        "degrees. Default: 0.",
        json_schema_extra=give_unit("deg"),
    )
    neutral: Literal["lifted", "resting"] = Field(
        default="lifted",
        description="lifted: rest is no hand on the gel. resting: the hand stays on it, and rest "
        "is how it lies, known once it has been still for a second, or for a second for each mm "
        "by which it drags the gel. Default: lifted.",
    )
    fatigue: Literal["none", "suggest", "auto"] = Field(
        default="suggest",
        description="What is done when a movement fades by a fifth: none, suggest a smaller range "
        "in the status, or auto, which needs up to 40 % less from then on, by 1 % a minute, until "
        "a pause. Default: suggest.",
    )
    slots: Annotated[
        list[Annotated[str, Field(pattern=NAME_PATTERN)]], Field(min_length=1, max_length=8)
    ] = Field(
        default=["default"],
        description="The favourite profiles that next_profile goes through. Default: [default].",
    )
    feedback: Feedback = Field(
        default_factory=Feedback.model_construct,
        description="What is heard of what the gestures do. Default: nothing.",
    )


def choose_filter(profile: Profile, user: UserSettings) -> FilterName:
    """Returns the tremor filter: the person's own, that of their patience, or the profile's."""
    own = user.filter
    if own is None and user.timing is None:
        own = profile.filter
    return own or resolve_times(profile.timing, user.timing).filter


def user_schema() -> dict[str, Any]:
    """Returns the JSON Schema of the user's file; shipped as ``profiles/schema/user-1.json``."""
    return make_schema(UserSettings, "neurotouch_hid user settings")
