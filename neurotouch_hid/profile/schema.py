"""What a profile may say: version 1 of the file format, strict, bounded and self-describing.

A profile is a list of bindings. Each binding says *when* (a gesture, perhaps narrowed by direction,
number of fingers and thresholds) and what to *do* (exactly one output of the pad).
"""

from collections.abc import Callable
from typing import Annotated, Any, Final, Literal, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    model_validator,
)
from pydantic_core import PydanticCustomError

from neurotouch_hid.messages import Button, GestureKind

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
Direction = Literal["left", "right", "up", "down"]
Side = Literal["left", "right"]
StickAxis = Literal["left_x", "left_y", "right_x", "right_y"]


def _unit(unit: str) -> dict[str, Any]:
    return {"x-unit": unit}


def _optional(unit: str | None = None) -> Callable[[dict[str, Any]], None]:
    """A key that may be left out but not be empty; a document's null never gets this far."""

    def describe(schema: dict[str, Any]) -> None:
        schema.pop("default")
        schema.update(schema.pop("anyOf")[0])
        if unit is not None:
            schema["x-unit"] = unit

    return describe


def _known_version(version: int) -> int:
    if version != 1:
        raise PydanticCustomError("version", "this program reads version 1 of the format")
    return version


class _Strict(BaseModel):
    model_config = ConfigDict(
        strict=True,
        extra="forbid",
        allow_inf_nan=False,
        frozen=True,
        hide_input_in_errors=True,
    )


class Condition(_Strict):
    """When a binding acts: a gesture, narrowed as far as the keys say."""

    gesture: GestureName = Field(
        description="The gesture. Clockwise and counter-clockwise are as seen by the user. "
        "No default."
    )
    direction: Direction | None = Field(
        default=None,
        description="Only a push this way, within 45° to either side; down is towards the user. "
        "Default: any direction.",
        json_schema_extra=_optional(),
    )
    contacts: Annotated[int, Field(ge=1, le=3)] | None = Field(
        default=None,
        description="Only with this many fingers. Counting is right in 90 % of cases from 7 mm on, "
        "so do not let it alone guard anything important. Default: any number.",
        json_schema_extra=_optional("fingers"),
    )
    on_mm: Annotated[float, Field(ge=1.0, le=18.0)] | None = Field(
        default=None,
        description="Act from this intensity on, in mm. Default: 2.5 mm for buttons and the D-pad, "
        "no threshold for sticks, axes and triggers (their range does it).",
        json_schema_extra=_optional("mm"),
    )
    off_mm: Annotated[float, Field(ge=0.5, le=17.0)] | None = Field(
        default=None,
        description="Let go below this intensity, in mm. Default: 0.6 of on_mm, so 1.5 mm.",
        json_schema_extra=_optional("mm"),
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


class Expo(_Strict):
    """y = (1 - expo) x + expo x³: fine in the middle, full at the end."""

    expo: float = Field(
        ge=0.0,
        le=1.0,
        description="Share of the cubic, 0 (a straight line) to 1. No default.",
        json_schema_extra=_unit("1"),
    )


class Power(_Strict):
    """y = x ** power: above 1 fine in the middle, below 1 quick from the start."""

    power: float = Field(
        ge=0.2,
        le=5.0,
        description="The exponent, 0.2 to 5; 1 is a straight line. No default.",
        json_schema_extra=_unit("1"),
    )


CURVES: Final[dict[str, type[_Strict]]] = {"expo": Expo, "power": Power}


def _tag_curve(value: object) -> str | None:
    if isinstance(value, dict):
        forms = [key for key in CURVES if key in value]
        return f"<{forms[0]}>" if len(forms) == 1 else None
    tags = (f"<{key}>" for key, model in CURVES.items() if type(value) is model)
    return next(tags, "<word>" if value == "linear" else None)


Curve = Annotated[
    Annotated[Literal["linear"], Tag("<word>")]
    | Annotated[Expo, Tag("<expo>")]
    | Annotated[Power, Tag("<power>")],
    Discriminator(
        _tag_curve,
        custom_error_type="one_of",
        custom_error_message="needs exactly one of: linear, expo, power",
    ),
]

RangeMm = tuple[
    Annotated[float, Field(ge=0.0, le=5.0)],
    Annotated[float, Field(ge=1.0, le=18.0)],
]


class _Shaped(_Strict):
    """How an intensity becomes a value of 0..1: range, then dead zone, then curve, then sign."""

    range_mm: Annotated[RangeMm, Field(strict=False)] | None = Field(
        default=None,
        description="[rest, full]: the intensities, in mm, where the output begins to move and "
        "where it reaches its end. Default: 1 mm to 8 (push), 7 (pinch, twist) or 4.5 mm (zoom).",
        json_schema_extra=_optional("mm"),
    )
    deadzone: float = Field(
        default=0.05,
        ge=0.0,
        le=0.9,
        description="Share of the range that stays exactly 0; what is left is stretched, so "
        "nothing jumps. Round for a stick. Default: 0.05.",
        json_schema_extra=_unit("1"),
    )
    curve: Curve = Field(
        default="linear",
        description="linear, {expo: 0..1} or {power: 0.2..5}. Default: linear.",
    )

    @model_validator(mode="after")
    def _has_extent(self) -> Self:
        if self.range_mm is not None and self.range_mm[1] - self.range_mm[0] < 0.5:
            raise PydanticCustomError(
                "range",
                "full must be at least 0.5 mm above rest, or the output would jump",
                {"at": ("range_mm",)},
            )
        return self


class StickTarget(_Shaped):
    """A push moves a whole stick, the way and as far as it goes."""

    stick: Side = Field(description="The stick. No default.")
    invert_x: bool = Field(default=False, description="Swap left and right. Default: false.")
    invert_y: bool = Field(
        default=False, description="Swap up and down, as in aircraft. Default: false."
    )


class AxisTarget(_Shaped):
    """An intensity moves one axis of a stick one way."""

    axis: StickAxis = Field(description="The axis; right and down are positive. No default.")
    sign: Literal["+", "-"] = Field(
        default="+",
        description='Which way: "+" is right or down, "-" is left or up. Default: "+".',
    )


class TriggerTarget(_Shaped):
    """An intensity pulls a trigger."""

    trigger: Side = Field(description="The trigger. No default.")


class ButtonTarget(_Strict):
    """A button is down while the condition holds."""

    button: Annotated[Button, Field(strict=False)] = Field(
        description="The button, by the word printed on it. No default."
    )


class DpadTarget(_Strict):
    """The D-pad is pressed one way while the condition holds."""

    dpad: Direction = Field(description="The way. No default.")


Target = StickTarget | AxisTarget | TriggerTarget | ButtonTarget | DpadTarget

TARGETS: Final[dict[str, type[_Strict]]] = {
    "stick": StickTarget,
    "axis": AxisTarget,
    "trigger": TriggerTarget,
    "button": ButtonTarget,
    "dpad": DpadTarget,
}


def _tag_target(value: object) -> str | None:
    if not isinstance(value, dict):
        return next((f"<{key}>" for key, model in TARGETS.items() if type(value) is model), None)
    forms = [key for key in TARGETS if key in value]
    return f"<{forms[0]}>" if len(forms) == 1 else None


def _tag_condition(value: object) -> str:
    return "<pattern>" if isinstance(value, dict | Condition) else "<name>"


class Binding(_Strict):
    """One line of a profile: when this, do that."""

    when: Annotated[
        Annotated[GestureName, Tag("<name>")] | Annotated[Condition, Tag("<pattern>")],
        Discriminator(_tag_condition),
    ] = Field(description="A gesture's name, or its name with what narrows it. No default.")
    do: Annotated[
        Annotated[StickTarget, Tag("<stick>")]
        | Annotated[AxisTarget, Tag("<axis>")]
        | Annotated[TriggerTarget, Tag("<trigger>")]
        | Annotated[ButtonTarget, Tag("<button>")]
        | Annotated[DpadTarget, Tag("<dpad>")],
        Discriminator(
            _tag_target,
            custom_error_type="one_of",
            custom_error_message="needs exactly one of: " + ", ".join(TARGETS),
        ),
    ] = Field(description="Exactly one output, with its shaping. No default.")

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
        if isinstance(self.do, _Shaped) and self.do.range_mm is not None:
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


class Profile(_Strict):
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
