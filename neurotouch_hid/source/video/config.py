"""Settings of a video camera: everything a person may change, with units."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class VideoConfig:
    """Settings that are written to the camera before it starts; None: the driver chooses.

    Attributes:
        width: of the pictures, px.
        height: of the pictures, px.
        fps: largest number of pictures/s.
        format: V4L2's four letters of the pixel format.
        exposure_us: exposure of a picture.
        gain: in the camera's own steps.
        mains_hz: frequency of the mains, 50 or 60; 0 if no lamp in the room flickers with it.
        mirrored: the camera sees the gel mirrored; the source mirrors it back.
    """

    width: int | None = None
    height: int | None = None
    fps: float | None = None
    format: str | None = None
    exposure_us: int | None = None
    gain: int | None = None
    mains_hz: int = 50
    mirrored: bool = False
