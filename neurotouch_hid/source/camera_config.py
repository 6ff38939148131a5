"""The settings of every kind of camera together, as ``camera.yaml`` has them."""

from dataclasses import dataclass, field

from neurotouch_hid.source.davis.config import DavisConfig
from neurotouch_hid.source.video.config import VideoConfig


@dataclass(frozen=True, slots=True)
class CameraConfig:
    """How a camera is set up, whichever it is.

    Attributes:
        davis: of a DAVIS.
        video: of a video camera.
    """

    davis: DavisConfig = field(default_factory=DavisConfig)
    video: VideoConfig = field(default_factory=VideoConfig)
