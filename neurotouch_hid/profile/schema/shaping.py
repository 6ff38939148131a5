"""Shaping of a measure into the value of an axis; ``engine.response`` carries it out.

centre ─ dead zone ─ range ─ curve ─ gain ─ anti-dead zone ─ saturate ─ slew limit ─ invert
"""

from itertools import pairwise
from typing import Annotated, Final, Literal, Self

from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator
from pydantic_core import PydanticCustomError

from neurotouch_hid.profile.schema.strict import Strict, find_tag, give_unit, make_optional

Measure = Literal["intensity", "speed", "push_x", "push_y", "position_x", "position_y"]


class Expo(Strict):
    """y = (1 - expo) x + expo x³: fine in the middle; below 0 its mirror image, quick at once."""

    expo: float = Field(
        ge=-1.0,
        le=1.0,
        description="Share of the cubic, -1 (quick in the middle) to 1 (fine in the middle); 0 is "
        "a straight line. No default.",
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


Contribution = Annotated[float, Field(ge=0.0, le=1.0)]
Point = Annotated[tuple[Contribution, Contribution], Field(strict=False)]


def _check_points(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    for (x, y), (next_x, next_y) in pairwise(points):
        # 0.18 - 0.17 is a little less than 0.01.
        if round(next_x - x, 9) < 0.01 or next_y < y:
            raise PydanticCustomError(
                "points", "each point must be right of the one before by 0.01, and not below it"
            )
    return points


class Points(Strict):
    """A smooth line through points, which never falls and never swings beyond them."""

    points: Annotated[list[Point], AfterValidator(_check_points)] = Field(
        min_length=1,
        max_length=16,
        description="[[x, y], ...] from 0 to 1, left to right; [0, 0] and [1, 1] are added where "
        "no point is at that end. No default.",
    )


CURVES: Final[dict[str, type[Strict]]] = {"expo": Expo, "power": Power, "points": Points}

Curve = Annotated[
    Annotated[Literal["linear"], Tag("<word>")]
    | Annotated[Expo, Tag("<expo>")]
    | Annotated[Power, Tag("<power>")]
    | Annotated[Points, Tag("<points>")],
    Discriminator(
        lambda value: "<word>" if value == "linear" else find_tag(value, CURVES),
        custom_error_type="one_of",
        custom_error_message="needs exactly one of: linear, expo, power, points",
    ),
]

RangeMm = tuple[
    Annotated[float, Field(ge=0.0, le=5.0)],
    Annotated[float, Field(ge=1.0, le=18.0)],
]
SpeedRange = tuple[
    Annotated[float, Field(ge=0.0, le=100.0)],
    Annotated[float, Field(ge=10.0, le=300.0)],
]


class Shaped(Strict):
    """Shaping of a measure into a value of 0..1."""

    range_mm: Annotated[RangeMm, Field(strict=False)] | None = Field(
        default=None,
        description="[rest, full]: where the output begins to move and where it reaches its end, "
        "in mm. Default: 1 mm to 8 (push), 7 (pinch, twist) or 4.5 mm (zoom); 2 to 18 mm for a "
        "position.",
        json_schema_extra=make_optional("mm"),
    )
    deadzone: float = Field(
        default=0.05,
        ge=0.0,
        le=0.9,
        description="Share of the range that stays exactly 0; what is left is stretched, so "
        "nothing jumps. Default: 0.05.",
        json_schema_extra=give_unit("1"),
    )
    curve: Curve = Field(
        default="linear",
        description="linear, {expo: -1..1}, {power: 0.2..5} or {points: [[x, y], ...]}. "
        "Default: linear.",
    )
    gain: float = Field(
        default=1.0,
        ge=0.1,
        le=5.0,
        description="What the value is multiplied with after the curve. Default: 1.",
        json_schema_extra=give_unit("1"),
    )
    anti_deadzone: float = Field(
        default=0.0,
        ge=0.0,
        le=0.5,
        description="Where the output begins once it moves, to jump over the dead zone a game has "
        "of its own. Default: 0.",
        json_schema_extra=give_unit("1"),
    )
    saturate: float = Field(
        default=1.0,
        ge=0.1,
        le=1.0,
        description="The largest value the output ever has. Default: 1.",
        json_schema_extra=give_unit("1"),
    )
    slew_per_s: Annotated[float, Field(ge=0.1, le=100.0)] | None = Field(
        default=None,
        description="The most the output may grow or turn in a second; releasing is never "
        "delayed. Default: no limit.",
        json_schema_extra=make_optional("1/s"),
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


class Planar(Shaped):
    """Shaping of a whole stick or of the mouse: two axes that belong together."""

    follow: Literal["push", "position"] = Field(
        default="push",
        description="What it follows: the push, or where on the gel the fingers are. "
        "Default: push.",
    )
    centre_mm: Annotated[
        tuple[
            Annotated[float, Field(ge=-15.0, le=15.0)], Annotated[float, Field(ge=-15.0, le=15.0)]
        ],
        Field(strict=False),
    ] = Field(
        default=(0.0, 0.0),
        description="[x, y], in mm, that counts as no movement; right and towards the user are "
        "positive. Default: [0, 0].",
        json_schema_extra=give_unit("mm"),
    )
    deadzone_shape: Literal["radial", "axial"] = Field(
        default="radial",
        description="radial: a round dead zone, the same in every direction. axial: one for each "
        "axis, which makes straight lines easier. Default: radial.",
    )
    invert_x: bool = Field(default=False, description="Swap left and right. Default: false.")
    invert_y: bool = Field(
        default=False, description="Swap up and down, as in aircraft. Default: false."
    )


class Linear(Shaped):
    """Shaping of one axis."""

    follow: Measure = Field(
        default="intensity",
        description="What it follows: how far (intensity) or how fast (speed) the gesture goes, "
        "one part of a push (push_x, push_y), or where on the gel the fingers are (position_x, "
        "position_y). Default: intensity.",
    )
    range_mm_s: Annotated[SpeedRange, Field(strict=False)] | None = Field(
        default=None,
        description="[rest, full] for speed, in mm/s. Default: 20 to 150 mm/s.",
        json_schema_extra=make_optional("mm/s"),
    )
    invert: bool = Field(default=False, description="Swap the two ways. Default: false.")

    @model_validator(mode="after")
    def _range_fits_the_measure(self) -> Self:
        if self.range_mm_s is not None:
            if self.follow != "speed":
                raise PydanticCustomError(
                    "speed_range", "only with 'follow: speed'", {"at": ("range_mm_s",)}
                )
            if self.range_mm_s[1] - self.range_mm_s[0] < 10.0:
                raise PydanticCustomError(
                    "range",
                    "full must be at least 10 mm/s above rest, or the output would jump",
                    {"at": ("range_mm_s",)},
                )
        elif self.follow == "speed" and self.range_mm is not None:
            raise PydanticCustomError(
                "speed_range", "a speed has its range in 'range_mm_s'", {"at": ("range_mm",)}
            )
        return self
