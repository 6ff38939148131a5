"""Settings of an event camera: everything a person may change, with units."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from neurotouch_hid.source.strobe.config import StrobeConfig


@dataclass(frozen=True, slots=True)
class EventsConfig:
    """Settings of an event camera.

    Attributes:
        px_per_mm: how large it sees the gel; None shows the whole picture.
        centre_px: where it sees the gel's centre, (x, y) px; None is the middle of its picture.
        max_events_per_s: more are dropped in the camera, where it can; 0 for no limit.
        biases: values by model, then by the maker's name of a bias; of others the library's stay.
        mirrored: the camera sees the gel mirrored; the source mirrors it back.
        strobe: how the LED ring is switched; None if it stays on.
    """

    px_per_mm: float | None = None
    centre_px: tuple[float, float] | None = None
    max_events_per_s: int = 20_000_000
    biases: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    mirrored: bool = False
    strobe: StrobeConfig | None = None
