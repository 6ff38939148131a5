"""The gel before the camera, as a ``gel.yaml`` describes it."""

import math
from typing import Annotated, Any, Final, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Discriminator, Field, Tag, model_validator
from pydantic_core import PydanticCustomError

from neurotouch_hid.driver.making_settings import Making
from neurotouch_hid.geometry import (
    MOST_MARKERS,
    PAPER_GEL,
    Gel,
    make_gel,
    measure_pitch,
    place_grid,
    place_hex,
    place_rings,
    place_square,
)
from neurotouch_hid.profile.schema import (
    SettingsFile,
    Strict,
    give_unit,
    make_optional,
    make_schema,
)
from neurotouch_hid.vocabulary import (
    NAME_PATTERN,
)

LEAST_DOTS: Final = 40
MOST_FAR_MM: Final = 31.0
"""Farther from the middle the recogniser does not expect any gel."""

_NEEDS: Final[dict[str, tuple[str, ...]]] = {
    "square": ("pitch_mm", "radius_mm"),
    "hex": ("pitch_mm", "radius_mm"),
    "rings": ("pitch_mm", "radius_mm"),
    "grid": ("columns", "rows", "pitch_mm"),
    "points": ("points_mm",),
}
"""The keys of each kind of layout, all of them needed."""

Length = Annotated[float, Field(ge=0.5, le=MOST_FAR_MM)]
Coordinate = Annotated[float, Field(ge=-MOST_FAR_MM, le=MOST_FAR_MM)]
Count = Annotated[int, Field(ge=2, le=200)]
Pitch = Annotated[
    Annotated[Length, Tag("<number>")]
    | Annotated[list[Length], Field(min_length=2, max_length=2), Tag("<list>")],
    Discriminator(lambda value: "<list>" if isinstance(value, list) else "<number>"),
]


def _key(description: str, unit: str | None = None) -> Any:
    return Field(default=None, description=description, json_schema_extra=make_optional(unit))


def _drop_null(schema: dict[str, Any]) -> None:
    """Leaves the forms of a key that may be left out but not be empty."""
    schema.pop("default")
    schema["anyOf"] = schema["anyOf"][0]["oneOf"]
    schema["x-unit"] = "mm"


class Layout(Strict):
    """The places of the dots on the gel, seen from above: x right, y towards the user."""

    kind: Literal["square", "hex", "rings", "grid", "points"] = Field(
        description="square: rows and columns within a circle, one dot in the middle. hex: the "
        "same with rows shifted by half of the pitch. rings: one dot in the middle and 6, 12, "
        "18, ... dots on rings around it. grid: a rectangle. points: a list. No default."
    )
    pitch_mm: Pitch | None = Field(
        default=None,
        description="Distance of neighbours in mm, from centre to centre; of a grid also [x, y]. "
        "Default: none.",
        json_schema_extra=_drop_null,
    )
    radius_mm: Length | None = _key(
        "Of the circle that contains all dots' centres, in mm. Default: none.", "mm"
    )
    columns: Count | None = _key("Dots from left to right, of a grid. Default: none.")
    rows: Count | None = _key("Dots from top to bottom, of a grid. Default: none.")
    points_mm: (
        Annotated[
            list[Annotated[list[Coordinate], Field(min_length=2, max_length=2)]],
            Field(min_length=LEAST_DOTS, max_length=MOST_MARKERS),
        ]
        | None
    ) = _key("Centre of each dot in mm, [[x, y], ...]. Default: none.", "mm")

    @model_validator(mode="after")
    def _has_the_keys_of_its_kind(self) -> Self:
        needed = _NEEDS[self.kind]
        for key in type(self).model_fields:
            given = key in self.model_fields_set
            if key != "kind" and given and key not in needed:
                raise PydanticCustomError(
                    "layout",
                    "'kind: {kind}' has no such key",
                    {"kind": self.kind, "at": (key,), "hint": f"it has {', '.join(needed)}"},
                )
            if key in needed and not given:
                raise PydanticCustomError(
                    "layout",
                    "'kind: {kind}' needs the key '{key}'",
                    {"kind": self.kind, "key": key, "at": ("kind",)},
                )
        if isinstance(self.pitch_mm, list) and self.kind != "grid":
            raise PydanticCustomError(
                "layout", "only a grid has two distances", {"at": ("pitch_mm",)}
            )
        self._check_dots()
        return self

    def _check_dots(self) -> None:
        """Checks how many dots there are, and how far from the middle."""
        at = next(key for key in ("radius_mm", "columns", "points_mm") if key in _NEEDS[self.kind])
        n = self.count()
        if not LEAST_DOTS <= n <= MOST_MARKERS:
            raise PydanticCustomError(
                "layout",
                "gives {n} dots, and a gel has {least} to {most}",
                {"n": n, "least": LEAST_DOTS, "most": MOST_MARKERS, "at": (at,)},
            )
        far_mm = np.hypot(*self.place().T)
        if far_mm.max() > MOST_FAR_MM + 1e-6:
            raise PydanticCustomError(
                "layout",
                "dot {number} is {far} mm from the middle, and {most} mm are possible",
                {
                    "number": int(far_mm.argmax()) + 1,
                    "far": f"{far_mm.max():.3g}",
                    "most": f"{MOST_FAR_MM:g}",
                    "at": (at,),
                },
            )

    def count(self) -> int:
        """Returns the number of dots, or a larger one than a gel may have."""
        if self.kind == "grid":
            return (self.columns or 0) * (self.rows or 0)
        if self.kind != "points":
            radius_mm, pitch_mm = self.radius_mm or 0.0, self._pitches()[0]
            if math.pi * (radius_mm / pitch_mm) ** 2 > 2 * MOST_MARKERS:
                return round(math.pi * (radius_mm / pitch_mm) ** 2)
        return len(self.place())

    def place(self) -> NDArray[np.float64]:
        """Returns the centres of all dots, (n, 2) float64 mm."""
        radius_mm, (x_mm, y_mm) = self.radius_mm or 0.0, self._pitches()
        match self.kind:
            case "square":
                return place_square(x_mm, radius_mm)
            case "hex":
                return place_hex(x_mm, radius_mm)
            case "rings":
                return place_rings(x_mm, radius_mm)
            case "grid":
                return place_grid(self.columns or 0, self.rows or 0, x_mm, y_mm)
            case "points":
                return np.array(self.points_mm, np.float64)

    def _pitches(self) -> tuple[float, float]:
        """Returns the distances from left to right and from top to bottom; 1 of points."""
        pitch_mm = self.pitch_mm if self.pitch_mm is not None else 1.0
        if isinstance(pitch_mm, list):
            return pitch_mm[0], pitch_mm[1]
        return pitch_mm, pitch_mm


class GelSettings(SettingsFile):
    """The file ``gel.yaml``."""

    name: Annotated[str, Field(pattern=NAME_PATTERN)] = Field(
        default="own",
        description="What you call the gel: small letters, digits, _ and -, at most 64. "
        "Default: own.",
    )
    layout: Layout = Field(description="Where the dots are. No default.")
    dot_mm: Annotated[float, Field(ge=0.2, le=20.0)] = Field(
        default=PAPER_GEL.dot_mm,
        description="Diameter of a dot in mm. Default: 1.",
        json_schema_extra=give_unit("mm"),
    )
    dots: Literal["light", "dark"] = Field(
        default="light",
        description="light: light dots on a dark gel; dark: dark dots on a light gel. "
        "Default: light.",
    )
    dome_height_mm: Annotated[float, Field(ge=0.0, le=50.0)] = Field(
        default=PAPER_GEL.dome_height_mm,
        description="How many mm the middle of the gel is higher than its rim; 0: it is flat. The "
        "simulator uses it. Default: 15.",
        json_schema_extra=give_unit("mm"),
    )

    making: Making = Field(
        default_factory=Making,
        description="The way to make the gel, and its camera. Only `neurotouch gel` uses it. "
        "Default: a cast dome on a webcam.",
    )

    @model_validator(mode="after")
    def _has_room_for_its_dots(self) -> Self:
        points = self.layout.place()
        away = np.hypot(*(points[:, None] - points).transpose(2, 0, 1))
        np.fill_diagonal(away, np.inf)
        first, second = np.unravel_index(away.argmin(), away.shape)
        nearest = float(away[first, second])
        if nearest > self.dot_mm:
            return self
        is_list = self.layout.kind == "points"
        raise PydanticCustomError(
            "layout",
            "dots {first} and {second} are {nearest} mm apart, and each is {dot} mm wide",
            {
                "first": int(first) + 1,
                "second": int(second) + 1,
                "nearest": f"{nearest:.3g}",
                "dot": f"{self.dot_mm:g}",
                "at": ("layout", "points_mm", int(second)) if is_list else ("layout", "pitch_mm"),
                "hint": "give dots larger distances, or a smaller 'dot_mm'",
            },
        )

    def make(self) -> Gel:
        """Returns the gel."""
        points_mm, radius_mm = self.layout.place(), self.layout.radius_mm
        pitch_mm = self.layout.pitch_mm
        if not isinstance(pitch_mm, float):  # of a list, or of a grid with two of them
            pitch_mm = measure_pitch(points_mm)
        if radius_mm is None:
            radius_mm = float(np.hypot(*points_mm.T).max()) + 0.25 * pitch_mm
        return make_gel(
            self.name,
            points_mm,
            pitch_mm=pitch_mm,
            radius_mm=radius_mm,
            dot_mm=self.dot_mm,
            light=self.dots == "light",
            dome_height_mm=self.dome_height_mm,
        )


def gel_schema() -> dict[str, Any]:
    """Returns the JSON Schema of a gel file; shipped as ``profiles/schema/gel-1.json``."""
    return make_schema(GelSettings, "neurotouch_hid gel")
