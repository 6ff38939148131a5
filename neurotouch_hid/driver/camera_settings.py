"""The settings of a person's camera: the file ``camera.yaml`` beside the person's own values."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Final, Literal

from pydantic import AfterValidator, Field
from pydantic_core import PydanticCustomError

from neurotouch_hid.players import find_user_file
from neurotouch_hid.profile.editing import ProfileText, Store, read_text, set_value
from neurotouch_hid.profile.reading import load_settings
from neurotouch_hid.profile.schema import SettingsFile, Strict, give_unit, make_optional
from neurotouch_hid.source.camera_config import CameraConfig
from neurotouch_hid.source.davis.config import Biases, DavisConfig
from neurotouch_hid.source.davis.registers import CoarseFine
from neurotouch_hid.source.events.config import EventsConfig
from neurotouch_hid.source.strobe.config import StrobeConfig
from neurotouch_hid.source.video.config import VideoConfig

FILE: Final = "camera.yaml"
_NEW: Final = "version: 1\n"
_USUAL: Final = DavisConfig()


def _check_current(value: list[int]) -> list[int]:
    if not (0 <= value[0] <= 7 and 0 <= value[1] <= 255):
        raise PydanticCustomError("bias", "[coarse, fine], with coarse 0 to 7 and fine 0 to 255")
    return value


Current = Annotated[list[int], Field(min_length=2, max_length=2), AfterValidator(_check_current)]
PixelFormat = Literal["GREY", "NV12", "NV21", "YU12", "YV12", "YUYV", "UYVY", "MJPG", "JPEG"]
Pixel = Annotated[list[Annotated[int, Field(ge=0, le=345)]], Field(min_length=2, max_length=2)]


def _current(name: str, description: str) -> Any:
    value = list(getattr(_USUAL.biases, name))
    return Field(default=value, description=f"{description} Default: {value}.")


class BiasSettings(Strict):
    """Currents of the sensor, [coarse 0-7, fine 0-255], by the vendor's names."""

    DiffBn: Current = _current("DiffBn", "What OnBn and OffBn are compared with.")
    OnBn: Current = _current("OnBn", "More: fewer ON events.")
    OffBn: Current = _current("OffBn", "Less: fewer OFF events.")
    PrBp: Current = _current("PrBp", "More: follows fast motion in dim light, with more noise.")
    PrSFBp: Current = _current("PrSFBp", "The same for the stage behind it.")
    RefrBp: Current = _current("RefrBp", "More: a pixel rests for a shorter time.")


class VideoSettings(Strict):
    """A video camera; what is not given, the driver chooses."""

    width: Annotated[int, Field(ge=320, le=8192)] | None = Field(
        default=None,
        description="Width of the pictures, as 'neurotouch devices' lists it. Default: that of the "
        "most pictures/s.",
        json_schema_extra=make_optional("px"),
    )
    height: Annotated[int, Field(ge=120, le=8192)] | None = Field(
        default=None,
        description="Height of the pictures. Default: that of the most pictures/s.",
        json_schema_extra=make_optional("px"),
    )
    fps: Annotated[float, Field(ge=1.0, le=2000.0)] | None = Field(
        default=None,
        description="Largest number of pictures/s. Default: as many as the camera can send.",
        json_schema_extra=make_optional(),
    )
    format: PixelFormat | None = Field(
        default=None,
        description="Pixel format, by V4L2's four letters. Default: one without compression.",
        json_schema_extra=make_optional(),
    )
    exposure_us: Annotated[int, Field(ge=50, le=200_000)] | None = Field(
        default=None,
        description="Exposure of a picture. Default: half a period of the mains, in which lamps do "
        "not flicker, or 4000 if the rate allows no more.",
        json_schema_extra=make_optional("us"),
    )
    gain: Annotated[int, Field(ge=0, le=65_535)] | None = Field(
        default=None,
        description="Gain, in the camera's own steps. Default: the camera's usual one.",
        json_schema_extra=make_optional(),
    )
    mains_hz: Literal[0, 50, 60] = Field(
        default=50,
        description="Frequency of the mains; 0 if no lamp of the room flickers. Default: 50.",
        json_schema_extra=give_unit("Hz"),
    )


BiasName = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,31}$")]
BiasValue = Annotated[int, Field(ge=-32_768, le=65_535)]
ModelKey = Literal[
    "prophesee_evk4",
    "prophesee_evk3_hd",
    "centuryarks_vga",
    "lucid_triton",
    "inivation_dvxplorer",
    "inivation_davis346",
]
Coordinate = Annotated[float, Field(ge=0.0, le=8192.0, allow_inf_nan=False)]


class StrobeSettings(Strict):
    """The LED ring of an event camera, which goes off at regular times."""

    hz: Annotated[float, Field(ge=5.0, le=50.0, allow_inf_nan=False)] = Field(
        default=StrobeConfig().hz,
        description="How often it goes off. Default: 20.",
        json_schema_extra=give_unit("Hz"),
    )
    dark_us: Annotated[int, Field(ge=500, le=5_000)] = Field(
        default=StrobeConfig().dark_us,
        description="For how long. Default: 1500.",
        json_schema_extra=give_unit("us"),
    )


class EventsSettings(Strict):
    """An event camera that is opened with 'events:'."""

    px_per_mm: Annotated[float, Field(ge=0.5, le=50.0)] | None = Field(
        default=None,
        description="How large it sees the gel. Default: the whole picture is used.",
        json_schema_extra=make_optional("px/mm"),
    )
    centre_px: Annotated[list[Coordinate], Field(min_length=2, max_length=2)] | None = Field(
        default=None,
        description="Where it sees the gel's centre, [x, y]. Default: in its middle.",
        json_schema_extra=make_optional("px"),
    )
    max_events_per_s: Annotated[int, Field(ge=0, le=1_000_000_000)] = Field(
        default=20_000_000,
        description="The camera drops more, where it can; 0: no limit. Default: 20000000.",
    )
    biases: dict[ModelKey, dict[BiasName, BiasValue]] = Field(
        default={},
        description="By model, then by the maker's name: prophesee_evk4: {diff_on: 20}. "
        "Default: the library's.",
    )
    strobe: StrobeSettings | None = Field(
        default=None,
        description="The LED ring goes off at regular times; see the circuit under Hardware. "
        "Default: it stays on.",
    )


class CameraSettings(SettingsFile):
    """The file ``camera.yaml``."""

    exposure_us: Annotated[int, Field(ge=10, le=1_000_000)] = Field(
        default=_USUAL.exposure_us,
        description="Exposure of a frame: more if frames are dark. Default: 4000.",
        json_schema_extra=give_unit("us"),
    )
    frame_interval_us: Annotated[int, Field(ge=0, le=1_000_000)] = Field(
        default=_USUAL.frame_interval_us,
        description="Time from frame to frame. Default: 40000.",
        json_schema_extra=give_unit("us"),
    )
    activity_filter_us: Annotated[int, Field(ge=0, le=1_000_000)] = Field(
        default=_USUAL.activity_filter_us,
        description="An event needs a neighbour's within this time; 0: off. Default: 2000.",
        json_schema_extra=give_unit("us"),
    )
    early_packet_delay_us: Annotated[int, Field(ge=125, le=10_000)] = Field(
        default=_USUAL.early_packet_delay_us,
        description="Data waits so long for a full USB packet; more: less work. Default: 250.",
        json_schema_extra=give_unit("us"),
    )
    hot_pixels: Annotated[list[Pixel], Field(max_length=8)] = Field(
        default=[], description="Pixels [x, y] that never stop firing. Default: none."
    )
    mirrored: bool = Field(
        default=False, description="The camera sees the gel mirrored. Default: false."
    )
    rotation_deg: Annotated[float, Field(ge=-360.0, le=360.0)] | None = Field(
        default=None,
        description="Turn of the gel in the picture, clockwise: the nearest quarter turn to it is "
        "taken. 'neurotouch doctor --directions' finds it. Default: the last one.",
        json_schema_extra=make_optional(),
    )
    biases: BiasSettings = Field(
        default_factory=BiasSettings, description="For another light. Default: see there."
    )
    video: VideoSettings = Field(
        default_factory=VideoSettings,
        description="A video camera; of the keys above, it knows mirrored and rotation_deg. "
        "Default: see there.",
    )
    events: EventsSettings = Field(
        default_factory=EventsSettings,
        description="A camera of 'events:'; of the keys above, it knows mirrored and "
        "rotation_deg. Default: see there.",
    )

    @property
    def config(self) -> CameraConfig:
        """The same as the driver takes it.

        Raises:
            CameraError: a pixel is outside.
        """
        biases = {name: CoarseFine(*value) for name, value in self.biases}
        davis = DavisConfig(
            exposure_us=self.exposure_us,
            frame_interval_us=self.frame_interval_us,
            activity_filter_us=self.activity_filter_us,
            early_packet_delay_us=self.early_packet_delay_us,
            hot_pixels=tuple((x, y) for x, y in self.hot_pixels),
            mirrored=self.mirrored,
            biases=Biases(**biases),
        )
        video = VideoConfig(**self.video.model_dump(), mirrored=self.mirrored)
        centre, strobe = self.events.centre_px, self.events.strobe
        events = EventsConfig(
            px_per_mm=self.events.px_per_mm,
            centre_px=None if centre is None else (centre[0], centre[1]),
            max_events_per_s=self.events.max_events_per_s,
            biases={str(model): values for model, values in self.events.biases.items()},
            mirrored=self.mirrored,
            strobe=None if strobe is None else StrobeConfig(strobe.hz, strobe.dark_us),
        )
        return CameraConfig(davis, video, events)


def find_camera_file(player: int | None = None) -> Path:
    """Returns the file of these settings; it need not exist."""
    return find_user_file(player).with_name(FILE)


def load_camera_settings(player: int | None = None) -> CameraSettings:
    """Returns the settings as they are written; the defaults if there is no file.

    Args:
        player: the player number; None means the one of the environment.

    Raises:
        ProfileError: the file says something we cannot do; every mistake has line and column.
    """
    return load_settings(find_camera_file(player), CameraSettings)


def save_camera_settings(path: Path, changes: Mapping[str, object]) -> None:
    """Writes some values into a file of these settings; makes it if there is none.

    Args:
        path: the file.
        changes: the values, by their keys; comments and all else in the file stay.

    Raises:
        ProfileError: the file has errors, or it cannot be written.
    """
    text, before = ProfileText(_NEW, str(path)), None
    if path.exists():
        load_settings(path, CameraSettings)
        text, before = read_text(path)
    for key, value in changes.items():
        text = set_value(text, key, value, CameraSettings)
    Store(path, lambda: "").save(text.encode(), over=before, keep=False)


def load_camera_config(player: int | None = None) -> CameraConfig:
    """Returns the settings; the defaults if there is no file.

    Args:
        player: the player number; None means the one of the environment.

    Raises:
        ProfileError: the file says something we cannot do; every mistake has line and column.
        CameraError: a pixel is outside.
    """
    return load_camera_settings(player).config
