"""Camera settings: everything a person may change, with units."""

from dataclasses import dataclass
from typing import Final, NamedTuple

from neurotouch_hid.errors import CameraError
from neurotouch_hid.messages import SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX
from neurotouch_hid.source.davis.registers import (
    FILTER_TIME_MAX,
    FILTER_UNIT_US,
    N_FILTERED_PIXELS,
    CoarseFine,
)

MAX_EXPOSURE_US: Final = 4_194_303
MAX_FRAME_INTERVAL_US: Final = 8_388_607
MAX_EARLY_PACKET_DELAY_US: Final = 1_000_000


class Biases(NamedTuple):
    """The currents that shape events, coarse (0-7) and fine (0-255), by the vendor's names.

    Defaults are those of libcaer, neuromorphic-drivers and the vendor's own library.

    Attributes:
        DiffBn: with OnBn and OffBn the contrast thresholds: an event is due when the light has
            changed by about log(OnBn / DiffBn), or log(OffBn / DiffBn) downwards.
        OnBn: higher means fewer ON events.
        OffBn: lower means fewer OFF events.
        PrBp: bandwidth of the photoreceptor; more follows fast changes in dim light, with more
            noise.
        PrSFBp: bandwidth of the buffer behind it.
        RefrBp: more shortens the time a pixel rests after an event.
    """

    DiffBn: CoarseFine = CoarseFine(4, 39)
    OnBn: CoarseFine = CoarseFine(5, 255)
    OffBn: CoarseFine = CoarseFine(4, 1)
    PrBp: CoarseFine = CoarseFine(2, 58)
    PrSFBp: CoarseFine = CoarseFine(1, 16)
    RefrBp: CoarseFine = CoarseFine(4, 25)


class Roi(NamedTuple):
    """A part of the picture, all limits inclusive, image coordinates in px."""

    x_begin: int = 0
    y_begin: int = 0
    x_end: int = SENSOR_WIDTH_PX - 1
    y_end: int = SENSOR_HEIGHT_PX - 1

    @property
    def is_valid(self) -> bool:
        """True if it is a part of the picture."""
        return (
            0 <= self.x_begin <= self.x_end < SENSOR_WIDTH_PX
            and 0 <= self.y_begin <= self.y_end < SENSOR_HEIGHT_PX
        )


USUAL_BIASES: Final = Biases()
WHOLE: Final = Roi()


@dataclass(frozen=True, slots=True)
class DavisConfig:
    """Settings that are written to the camera before it starts.

    Attributes:
        exposure_us: exposure of a frame. 4 ms, libcaer's default; with the gel's own LED ring more
            only smears moving markers.
        frame_interval_us: from the start of a frame to the next. 40 ms, 25 Hz [NT, "Experiments"].
        early_packet_delay_us: how long data may wait for a full USB packet. Differs: drivers leave
            the 1 ms of power-up, for 250 µs less latency matter more than packets.
        activity_filter_us: an event passes if a neighbour fired within this time, in steps of
            250 µs; 0 switches it off. 2 ms as in libcaer: noise hits single pixels, a marker's edge
            hits several. The camera itself filters, at no cost.
        refractory_us: least time between two events of a pixel, in steps of 250 µs; 0 for none.
        hot_pixels: up to eight (x, y) that the camera silences.
        events_roi: where events come from.
        frames_roi: what frames show; black elsewhere.
        frames: whether there are frames. Without, the tracker cannot find the gel at rest again.
        biases: the currents that shape events.
        mirrored: the camera sees the gel mirrored; the source mirrors it back.
    """

    exposure_us: int = 4_000
    frame_interval_us: int = 40_000
    early_packet_delay_us: int = 250
    activity_filter_us: int = 2_000
    refractory_us: int = 0
    hot_pixels: tuple[tuple[int, int], ...] = ()
    events_roi: Roi = WHOLE
    frames_roi: Roi = WHOLE
    frames: bool = True
    biases: Biases = USUAL_BIASES
    mirrored: bool = False

    def __post_init__(self) -> None:
        """Refuses settings that the camera cannot apply.

        Raises:
            CameraError: names the value.
        """
        _check("exposure_us", self.exposure_us, 1, MAX_EXPOSURE_US)
        _check("frame_interval_us", self.frame_interval_us, 0, MAX_FRAME_INTERVAL_US)
        _check("early_packet_delay_us", self.early_packet_delay_us, 1, MAX_EARLY_PACKET_DELAY_US)
        longest = FILTER_TIME_MAX * FILTER_UNIT_US
        _check("activity_filter_us", self.activity_filter_us, 0, longest)
        _check("refractory_us", self.refractory_us, 0, longest)
        _check("number of hot_pixels", len(self.hot_pixels), 0, N_FILTERED_PIXELS)
        for x, y in self.hot_pixels:
            _check("x of a hot pixel", x, 0, SENSOR_WIDTH_PX - 1)
            _check("y of a hot pixel", y, 0, SENSOR_HEIGHT_PX - 1)
        for name in ("events_roi", "frames_roi"):
            if not getattr(self, name).is_valid:
                raise CameraError(
                    f"Setting {name} is not inside the picture: {getattr(self, name)}."
                )
        for name, (coarse, fine) in self.biases._asdict().items():
            _check(f"coarse value of {name}", coarse, 0, 7)
            _check(f"fine value of {name}", fine, 0, 255)


def _check(name: str, value: int, low: int, high: int) -> None:
    if not low <= value <= high:
        raise CameraError(f"The camera's {name} must be {low} to {high}, not {value}.")
