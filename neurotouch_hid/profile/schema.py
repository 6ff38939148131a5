"""What a profile may say: version 1 of the file format, strict, bounded and self-describing.

A profile is a list of bindings. Each binding says *when* (a gesture, perhaps narrowed by direction,
number of fingers and thresholds) and what to *do* (exactly one output of the pad).
"""

from typing import Annotated, Any, Final, Literal, Self

from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    Tag,
    model_validator,
)
from pydantic_core import PydanticCustomError

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile.strict import Strict, make_optional
from neurotouch_hid.profile.targets import (
    ButtonTarget,
    Direction,
    DpadTarget,
    Shaped,
    StickTarget,
    Target,
)

NAME_PATTERN: Final = r"^[a-z0-9_-]{1,64}$"

DEFAULT_ON_MM: Final = 2.5
"""Where an output that is either pressed or not presses: the type of a gesture is right in more
than 90 % of cases from 2.5 mm on [NT, "Results"]."""

OFF_SHARE: Final = 0.6
"""``off_mm`` as a share of ``on_mm`` where a profile does not say: 2.5 mm on, 1.5 mm off, a gap as
large as the mean error of the intensity (0.96 mm [NT, "Results"])."""

DEFAULT_REST_MM: Final = 1.0
"""Where an axis begins to move: just above the mean error of the intensity."""

DEFAULT_FULL_MM: Final = {
    GestureKind.PUSH: 8.0,
    GestureKind.PINCH: 7.0,
    GestureKind.ZOOM: 4.5,
    GestureKind.TWIST_CW: 7.0,
    GestureKind.TWIST_CCW: 7.0,
}
"""Where an axis reaches its end. Opening the hand is the weakest movement, pushing the strongest:
recorded zooms reach 8 mm, pushes 17.5 mm [NT, intensity figure]."""

GestureName = Literal["push", "pinch", "zoom", "twist_cw", "twist_ccw"]


def _known_version(version: int) -> int:
    if version != 1:
        raise PydanticCustomError("version", "this program reads version 1 of the format")
    return version


class Condition(Strict):
    """When a binding acts: a gesture, narrowed as far as the keys say."""

    gesture: GestureName = Field(
        description="The gesture. Clockwise and counter-clockwise are as seen by the user. "
        "No default."
    )
    direction: Direction | None = Field(
        default=None,
        description="Only a push this way, within 45° to either side; down is towards the user. "
        "Default: any direction.",
        json_schema_extra=make_optional(),
    )
    contacts: Annotated[int, Field(ge=1, le=3)] | None = Field(
        default=None,
        description="Only with this many fingers. Counting is right in 90 % of cases from 7 mm on, "
        "so do not let it alone guard anything important. Default: any number.",
        json_schema_extra=make_optional("fingers"),
    )
    on_mm: Annotated[float, Field(ge=1.0, le=18.0)] | None = Field(
        default=None,
        description="Act from this intensity on, in mm. Default: 2.5 mm for buttons and the D-pad, "
        "no threshold for sticks, axes and triggers (their range does it).",
        json_schema_extra=make_optional("mm"),
    )
    off_mm: Annotated[float, Field(ge=0.5, le=17.0)] | None = Field(
        default=None,
        description="Let go below this intensity, in mm. Default: 0.6 of on_mm, so 1.5 mm.",
        json_schema_extra=make_optional("mm"),
    )

    @property
    def kind(self) -> GestureKind:
        """The gesture as the recognizer names it."""
        return GestureKind[self.gesture.upper()]

    @property
    def thresholds_mm(self) -> tuple[float, float]:
        """Where it acts and where it lets go, in mm, defaults filled in."""
        on_mm = DEFAULT_ON_MM if self.on_mm is None else self.on_mm
        return on_mm, OFF_SHARE * on_mm if self.off_mm is None else self.off_mm

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        if self.direction is not None and self.gesture != "push":
            raise PydanticCustomError(
                "direction",
                "only a push has a direction, a {gesture} has none",
                {"at": ("direction",), "gesture": self.gesture},
            )
        on_mm, off_mm = self.thresholds_mm
        if off_mm >= on_mm:
            raise PydanticCustomError(
                "thresholds",
                "must be below on_mm ({on} mm), or the output would flicker",
                {"at": ("off_mm",), "on": f"{on_mm:g}"},
            )
        return self


def _tag_condition(value: object) -> str:
    return "<pattern>" if isinstance(value, dict | Condition) else "<name>"


class Binding(Strict):
    """One line of a profile: when this, do that."""

    when: Annotated[
        Annotated[GestureName, Tag("<name>")] | Annotated[Condition, Tag("<pattern>")],
        Discriminator(_tag_condition),
    ] = Field(description="A gesture's name, or its name with what narrows it. No default.")
    do: Target = Field(description="Exactly one output, with its shaping. No default.")

    @property
    def condition(self) -> Condition:
        """The long form of ``when``."""
        return Condition(gesture=self.when) if isinstance(self.when, str) else self.when

    @property
    def thresholds_mm(self) -> tuple[float, float]:
        """Where it acts and where it lets go, in mm; zeros where the range alone decides."""
        condition = self.condition
        digital = isinstance(self.do, ButtonTarget | DpadTarget)
        if digital or condition.on_mm is not None or condition.off_mm is not None:
            return condition.thresholds_mm
        return 0.0, 0.0

    @property
    def range_mm(self) -> tuple[float, float]:
        """Where the output begins to move and where it reaches its end, in mm."""
        if isinstance(self.do, Shaped) and self.do.range_mm is not None:
            return self.do.range_mm
        return DEFAULT_REST_MM, DEFAULT_FULL_MM[self.condition.kind]

    @model_validator(mode="after")
    def _stick_is_pushed(self) -> Self:
        if isinstance(self.do, StickTarget) and self.condition.gesture != "push":
            raise PydanticCustomError(
                "stick",
                "a whole stick follows the direction of a push; a {gesture} moves one axis, "
                "'axis: {stick}_x'",
                {
                    "at": ("do", "stick"),
                    "gesture": self.condition.gesture,
                    "stick": self.do.stick,
                },
            )
        return self


class Profile(Strict):
    """How gestures on the gel become a game controller."""

    version: Annotated[int, AfterValidator(_known_version)] = Field(
        description="The version of this format: 1. No default.", json_schema_extra={"const": 1}
    )
    name: str = Field(
        pattern=NAME_PATTERN,
        description="The profile's name: small letters, digits, _ and -, at most 64. No default.",
    )
    description: str = Field(
        default="", max_length=500, description="What it is for, in a sentence. Default: empty."
    )
    bindings: list[Binding] = Field(
        min_length=1,
        max_length=256,
        description="What each gesture does. Where two move one axis, the larger value counts; "
        "where they are equal, the earlier binding. No default.",
    )


def profile_schema() -> dict[str, Any]:
    """The JSON Schema of a profile, for editors; shipped as ``profiles/schema/profile-1.json``."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **Profile.model_json_schema(),
        "title": "neurotouch_hid profile",
    }
