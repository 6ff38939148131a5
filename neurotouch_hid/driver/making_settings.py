"""The part of ``gel.yaml`` that says how a gel is made, and with which camera it is seen."""

from typing import Annotated, Final, Literal

from pydantic import Field

from neurotouch_hid.profile.schema import Strict, give_unit

THINNEST_MM: Final = 1.2
"""No wall of a printed or cast part is thinner: three lines of a usual nozzle."""
PIT_MM: Final = 0.8
"""Depth of a dot in the skin."""


Way = Literal["evening", "printed", "cast"]
"""The ways to make a gel."""

Pixels = Annotated[int, Field(ge=120, le=8000)]


class Camera(Strict):
    """The camera below the gel, as a pinhole: the numbers of a webcam if nothing else is said."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9 ._-]{0,39}$")] = Field(
        default="webcam",
        description="What you call the camera: letters, digits, spaces, dots, _ and -, at most 40. "
        "Default: webcam.",
    )
    width_px: Pixels = Field(
        default=1280,
        description="Width of its picture in px. Default: 1280.",
        json_schema_extra=give_unit("px"),
    )
    height_px: Pixels = Field(
        default=720,
        description="Height of its picture in px. Default: 720.",
        json_schema_extra=give_unit("px"),
    )
    view_deg: Annotated[float, Field(ge=15.0, le=100.0)] = Field(
        default=43.3,
        description="Angle that the picture shows from top to bottom, in degrees. It is "
        "2 atan(h / 2f), h the height of the sensor and f the focal length. Default: 43.3.",
        json_schema_extra=give_unit("deg"),
    )
    fill: Annotated[float, Field(ge=0.4, le=0.95)] = Field(
        default=0.88,
        description="Share of the picture's height that the gel fills. Default: 0.88.",
    )
    seat: Literal["board", "straps"] = Field(
        default="straps",
        description="board: a bare board is screwed below the plate. straps: two cable ties hold "
        "the camera. Default: straps.",
    )
    lens_mm: Annotated[float, Field(ge=6.0, le=40.0)] = Field(
        default=24.0,
        description="Diameter of the hole for the lens, in mm. Default: 24.",
        json_schema_extra=give_unit("mm"),
    )
    pupil_mm: Annotated[float, Field(ge=-5.0, le=60.0)] = Field(
        default=0.0,
        description="How far the front of the lens is above the underside of the plate, in mm. "
        "Default: 0.",
        json_schema_extra=give_unit("mm"),
    )
    below_mm: Annotated[float, Field(ge=10.0, le=90.0)] = Field(
        default=40.0,
        description="Room that the camera needs below the plate, in mm. Default: 40.",
        json_schema_extra=give_unit("mm"),
    )


class Making(Strict):
    """The way to make the gel; only `neurotouch gel` reads it."""

    way: Way = Field(
        default="cast",
        description="evening: a flat skin, painted through a stencil. printed: a dome of two "
        "colours. cast: a silicone dome from a printed mould. Default: cast.",
    )
    skin_mm: Annotated[float, Field(ge=THINNEST_MM + PIT_MM, le=6.0)] = Field(
        default=2.0,
        description="Thickness of a printed or cast skin, in mm. Default: 2.",
        json_schema_extra=give_unit("mm"),
    )
    camera: Camera = Field(default_factory=Camera, description="The camera. Default: a webcam.")
