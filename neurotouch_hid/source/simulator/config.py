"""Settings of a simulated set-up: gel, camera, pixels, light."""

from dataclasses import dataclass, field, replace
from typing import Literal, get_args

from neurotouch_hid.geometry import NOMINAL_PX_PER_MM, PAPER_GEL, Gel, Rig

SHIPPED_RIG = Rig((172.5, 129.5), NOMINAL_PX_PER_MM)  # the middle of the sensor

Elasticity = Literal["half-space", "solid"]
ELASTICITIES: tuple[Elasticity, ...] = get_args(Elasticity)


@dataclass(frozen=True, slots=True)
class GelConfig:
    """Settings of the gel: its dots and its elasticity.

    Attributes:
        lag: share of the motion that follows late; silicone loses about a tenth of its work.
        lag_us: time constant of that share.
        elasticity: closed forms of a half space (``kernels``) or the solid dome of finite elements
            (``solid``); they share no code.
        residue: share of each marker's largest motion that stays until the next touch.
        layout: its dots.
        missing: places of dots that were never made, in ``Gel.points_mm``.
    """

    lag: float = 0.1
    lag_us: int = 120_000
    elasticity: Elasticity = "half-space"
    residue: float = 0.0
    layout: Gel = PAPER_GEL
    missing: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class CameraConfig:
    """The camera's place and the distortion of its lens.

    Attributes:
        rig: where the gel is in the image.
        distance_mm: from the lens to the plane of the rim.
        height_mm: of the dome over that plane.
        barrel: radial distortion of the lens in 1/mm² at the gel; nearly undoes the dome's.
        falloff: how fast a tilted marker loses brightness (power of the cosine).
        tilt_rad: how far the camera leans over, about the image's vertical axis through the gel.
        fisheye_rad: half of the angle under which an equidistant lens sees the gel; 0 is none.
    """

    rig: Rig = SHIPPED_RIG
    distance_mm: float = 90.0
    height_mm: float = 15.0
    barrel: float = 9e-5
    falloff: float = 0.7
    tilt_rad: float = 0.0
    fisheye_rad: float = 0.0


@dataclass(frozen=True, slots=True)
class SensorConfig:
    """The pixels of one camera; defaults from v2e's model of a DAVIS346 unless said otherwise.

    Attributes:
        contrast: mean threshold of both polarities, log units.
        contrast_spread: its standard deviation over pixels.
        cutoff_hz: bandwidth of the photoreceptor at white, 255 DN; less in the dark.
        refractory_us: dead time after an event.
        leak_hz: rate of ON events from the leak.
        shot_hz: rate of noise events of a dark pixel.
        n_hot: pixels that fire by themselves.
        hot_hz: their rate.
        row_us: period of the row-wise readout; 0 stamps every event exactly.
        blur_px: standard deviation of the lens's point spread.
        frame_us: frame period; 40 ms [NT, "System Overview"].
        exposure_us: exposure of a frame, a multiple of 500 µs.
        frame_gain: brightness of a frame in the same light, as another exposure makes it.
        read_noise_dn, gain_spread, offset_spread_dn: of the frame's pixels.
    """

    contrast: float = 0.2
    contrast_spread: float = 0.03
    cutoff_hz: float = 300.0
    refractory_us: float = 500.0
    leak_hz: float = 0.1
    shot_hz: float = 1.0
    n_hot: int = 0
    hot_hz: float = 200.0
    row_us: int = 0
    blur_px: float = 0.6
    frame_us: int = 40_000
    exposure_us: int = 10_000
    frame_gain: float = 1.0
    read_noise_dn: float = 1.5
    gain_spread: float = 0.015
    offset_spread_dn: float = 1.5


@dataclass(frozen=True, slots=True)
class LightConfig:
    """Settings of the light; levels in DN of an 8-bit frame.

    Attributes:
        white_dn: a marker at full light.
        black_dn: the gel's surface.
        uneven: relative difference of light from one side of the gel to the other.
        uneven_rad: direction of the brighter side.
        n_spots: bright spots (reflections, LEDs) outside the gel.
        spot_dn: their brightness.
        seed: where the spots are.
        vignetting: share of the light that the lens loses in the corners of the picture.
        ring_glare: brightness of the LED ring's reflection on the gel, in white markers.
    """

    white_dn: float = 200.0
    black_dn: float = 14.0
    uneven: float = 0.3
    uneven_rad: float = 0.6
    n_spots: int = 5
    spot_dn: float = 220.0
    seed: int = 0
    vignetting: float = 0.0
    ring_glare: float = 0.0


@dataclass(frozen=True, slots=True)
class UvcConfig:
    """The shutter and the processing of a UVC camera; ``SensorConfig`` has its rate and pixels.

    Attributes:
        readout_us: how much later the last row is exposed than the first; 0 is a global shutter.
        gamma: the camera sends light to the power of 1/gamma.
        jpeg_quality: of MJPEG, 1 to 100; 0 sends the pixels as they are.
        auto_exposure_dn: mean of the picture that auto exposure aims at; 0 is a fixed exposure.
    """

    readout_us: int = 0
    gamma: float = 1.0
    jpeg_quality: int = 0
    auto_exposure_dn: float = 0.0


@dataclass(frozen=True, slots=True)
class SimulatorConfig:
    """One simulated set-up: gel, camera, pixels, light; with ``uvc`` the camera sends no events."""

    gel: GelConfig = field(default_factory=GelConfig)
    camera: CameraConfig = field(default_factory=CameraConfig)
    sensor: SensorConfig = field(default_factory=SensorConfig)
    light: LightConfig = field(default_factory=LightConfig)
    uvc: UvcConfig | None = None

    def show(self, gel: Gel) -> "SimulatorConfig":
        """Returns the same set-up with another gel; the paper's changes nothing."""
        if gel is PAPER_GEL:
            return self
        return replace(
            self,
            gel=replace(self.gel, layout=gel),
            camera=replace(self.camera, height_mm=gel.dome_height_mm),
        )
