"""The cameras and hands that ``neurotouch gel new`` knows, and the file that it writes."""

from typing import Final, NamedTuple

from neurotouch_hid.driver.making_settings import Camera, Way
from neurotouch_hid.geometry import PAPER_GEL

CAMERAS: Final[dict[str, tuple[str, Camera]]] = {
    "webcam": ("an ordinary webcam, 78° from corner to corner", Camera()),
    "ps3eye": (
        "a PS3 Eye with its lens turned to the wide side, 75° from corner to corner",
        Camera(
            name="ps3eye",
            width_px=640,
            height_px=480,
            view_deg=49.4,
            lens_mm=30.0,
            below_mm=60.0,
        ),
    ),
    "board": (
        "a board of 38 mm with a 1280 x 800 sensor of 3 µm and a lens of 2.8 mm",
        Camera(
            name="board",
            width_px=1280,
            height_px=800,
            view_deg=46.4,
            seat="board",
            lens_mm=18.0,
            pupil_mm=18.0,
            below_mm=20.0,
        ),
    ),
    "davis346": (
        "a DAVIS-346 with a lens of 8 mm",
        Camera(
            name="davis346",
            width_px=346,
            height_px=260,
            view_deg=33.5,
            lens_mm=31.0,
            pupil_mm=30.0,
            below_mm=65.0,
        ),
    ),
}
"""What each is, and its numbers. Those of the maker's data sheet; lens and room are our guess."""


class Hand(NamedTuple):
    """A size of hand, and the gel for it.

    Attributes:
        what: the hand in words.
        radius_mm: of the gel.
        pitch_mm: distance of its dots.
    """

    what: str
    radius_mm: float
    pitch_mm: float


HANDS: Final[dict[str, Hand]] = {
    "small": Hand("a child's hand: a gel of 48 mm", 24.0, 3.2),
    "medium": Hand("a smaller hand: a gel of 54 mm", 27.0, 3.6),
    "large": Hand("a grown-up's hand: a gel of 60 mm, as in the paper", 30.0, 4.0),
}
WAYS: Final[dict[Way, str]] = {
    "evening": "a first evening: baking mat or balloon, white pen, paper stencil",
    "printed": "printed: a dome from a printer with two colours of soft filament",
    "cast": "cast: a silicone dome from a printed mould",
}


def write_gel_file(name: str, camera: Camera, hand: Hand, way: Way) -> str:
    """Returns the text of a new ``gel.yaml`` with 177 dots.

    Args:
        name: what the gel is called.
        camera: the camera.
        hand: the size of the hand.
        way: how the gel is made.
    """
    is_flat = way == "evening"
    share = hand.radius_mm / PAPER_GEL.radius_mm
    dot_mm = 1.5 * share if is_flat else PAPER_GEL.dot_mm * share  # a pen is not fine
    height_mm = 0.0 if is_flat else PAPER_GEL.dome_height_mm * share
    values = camera.model_dump()
    return "\n".join(
        [
            "# Written by 'neurotouch gel new'. What each key means: docs/gel-format.md",
            "version: 1",
            f'name: "{name}"',  # else YAML takes some names for numbers
            f"layout: {{kind: square, pitch_mm: {hand.pitch_mm:g}, radius_mm: {hand.radius_mm:g}}}",
            f"dot_mm: {dot_mm:g}",
            "dots: light",
            f"dome_height_mm: {height_mm:g}",
            "making:",
            f"  way: {way}",
            "  camera:",
            *(
                f"    {key}: {value:g}" if isinstance(value, float) else f"    {key}: {value}"
                for key, value in values.items()
            ),
            "",
        ]
    )
