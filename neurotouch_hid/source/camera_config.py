"""The settings of every kind of camera together, as ``camera.yaml`` has them."""

from dataclasses import dataclass, field

from neurotouch_hid.source.davis.config import DavisConfig
from neurotouch_hid.source.events.config import EventsConfig
from neurotouch_hid.source.video.config import VideoConfig


@dataclass(frozen=True, slots=True)
class CameraConfig:
    """The settings of a camera, of any kind.

    Attributes:
        davis: of a DAVIS.
        video: of a video camera.
        events: of an event camera of another maker.
    """

    davis: DavisConfig = field(default_factory=DavisConfig)
    video: VideoConfig = field(default_factory=VideoConfig)
    events: EventsConfig = field(default_factory=EventsConfig)
