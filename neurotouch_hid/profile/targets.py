"""What a binding may do: one output of the pad, and how an intensity becomes its value."""

from typing import Annotated, Final, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator
from pydantic_core import PydanticCustomError

from neurotouch_hid.messages import Button
from neurotouch_hid.profile.strict import Strict, find_tag, give_unit, make_optional

Side = Literal["left", "right"]
StickAxis = Literal["left_x", "left_y", "right_x", "right_y"]
Direction = Literal["left", "right", "up", "down"]


class Expo(Strict):
    """y = (1 - expo) x + expo x³: fine in the middle, full at the end."""

    expo: float = Field(
        ge=0.0,
        le=1.0,
        description="Share of the cubic, 0 (a straight line) to 1. No default.",
        json_schema_extra=give_unit("1"),
    )


class Power(Strict):
    """y = x ** power: above 1 fine in the middle, below 1 quick from the start."""

    power: float = Field(
        ge=0.2,
        le=5.0,
        description="The exponent, 0.2 to 5; 1 is a straight line. No default.",
        json_schema_extra=give_unit("1"),
    )


CURVES: Final[dict[str, type[Strict]]] = {"expo": Expo, "power": Power}


Curve = Annotated[
    Annotated[Literal["linear"], Tag("<word>")]
    | Annotated[Expo, Tag("<expo>")]
    | Annotated[Power, Tag("<power>")],
    Discriminator(
        lambda value: "<word>" if value == "linear" else find_tag(value, CURVES),
        custom_error_type="one_of",
        custom_error_message="needs exactly one of: linear, expo, power",
    ),
]

RangeMm = tuple[
    Annotated[float, Field(ge=0.0, le=5.0)],
    Annotated[float, Field(ge=1.0, le=18.0)],
]


class Shaped(Strict):
    """How an intensity becomes a value of 0..1: range, then dead zone, then curve, then sign."""

    range_mm: Annotated[RangeMm, Field(strict=False)] | None = Field(
        default=None,
        description="[rest, full]: the intensities, in mm, where the output begins to move and "
        "where it reaches its end. Default: 1 mm to 8 (push), 7 (pinch, twist) or 4.5 mm (zoom).",
        json_schema_extra=make_optional("mm"),
    )
    deadzone: float = Field(
        default=0.05,
        ge=0.0,
        le=0.9,
        description="Share of the range that stays exactly 0; what is left is stretched, so "
        "nothing jumps. Round for a stick. Default: 0.05.",
        json_schema_extra=give_unit("1"),
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


class StickTarget(Shaped):
    """A push moves a whole stick, the way and as far as it goes."""

    stick: Side = Field(description="The stick. No default.")
    invert_x: bool = Field(default=False, description="Swap left and right. Default: false.")
    invert_y: bool = Field(
        default=False, description="Swap up and down, as in aircraft. Default: false."
    )


class AxisTarget(Shaped):
    """An intensity moves one axis of a stick one way."""

    axis: StickAxis = Field(description="The axis; right and down are positive. No default.")
    sign: Literal["+", "-"] = Field(
        default="+",
        description='Which way: "+" is right or down, "-" is left or up. Default: "+".',
    )


class TriggerTarget(Shaped):
    """An intensity pulls a trigger."""

    trigger: Side = Field(description="The trigger. No default.")


class ButtonTarget(Strict):
    """A button is down while the condition holds."""

    button: Annotated[Button, Field(strict=False)] = Field(
        description="The button, by the word printed on it. No default."
    )


class DpadTarget(Strict):
    """The D-pad is pressed one way while the condition holds."""

    dpad: Direction = Field(description="The way. No default.")


TARGETS: Final[dict[str, type[Strict]]] = {
    "stick": StickTarget,
    "axis": AxisTarget,
    "trigger": TriggerTarget,
    "button": ButtonTarget,
    "dpad": DpadTarget,
}

Target = Annotated[
    Annotated[StickTarget, Tag("<stick>")]
    | Annotated[AxisTarget, Tag("<axis>")]
    | Annotated[TriggerTarget, Tag("<trigger>")]
    | Annotated[ButtonTarget, Tag("<button>")]
    | Annotated[DpadTarget, Tag("<dpad>")],
    Discriminator(
        lambda value: find_tag(value, TARGETS),
        custom_error_type="one_of",
        custom_error_message="needs exactly one of: " + ", ".join(TARGETS),
    ),
]
