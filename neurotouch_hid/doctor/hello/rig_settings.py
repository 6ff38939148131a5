"""The simulator's settings of a rig that ``neurotouch hello`` has met: ``simulator.yaml``."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Final, Literal, NamedTuple

from pydantic import Field

from neurotouch_hid.driver.gel_file import ChosenGel, parse_gel
from neurotouch_hid.errors import RecordingError
from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, suggest_reading
from neurotouch_hid.files.zip_parts import read_parts
from neurotouch_hid.geometry import NOMINAL_PX_PER_MM, PAPER_GEL, Gel, Rig
from neurotouch_hid.printable import make_printable
from neurotouch_hid.profile.reading import parse_settings
from neurotouch_hid.profile.schema import Strict, give_unit
from neurotouch_hid.source.simulator.config import SHIPPED_RIG, SimulatorConfig, UvcConfig
from neurotouch_hid.source.simulator.optics import PIXEL_BLUR_PX
from neurotouch_hid.source.simulator.sensor import TICK_US

CameraKind = Literal["events", "events-only", "pictures"]
FILE: Final = "simulator.yaml"
GEL_FILE: Final = "gel.yaml"
"""Its parts in the zip file; without a gel, it is the paper's."""


def _measured(least: float, most: float, description: str, unit: str | None = None) -> Any:
    extra = give_unit(unit) if unit else None
    return Field(default=None, ge=least, le=most, description=description, json_schema_extra=extra)


_HEAD: Final = """\
# What 'neurotouch hello' measured of one rig, as settings of the simulator:
# neurotouch simulate OUT --like FILE.hello.zip
# Only what was measured is here; the rest is as usual. Never here: the contrast that makes an
# event, bandwidth, stiffness, unevenness of the light, distortion of the lens.
"""


class RigSettings(Strict):
    """Settings of the simulator for one rig; a key that is missing was not measured."""

    version: Literal[1] = Field(default=1, description="The version of this format.")
    simulated: bool = Field(
        default=False, description="true: the rig was itself a simulation, and no camera."
    )
    camera: CameraKind = Field(
        default="events",
        description="events: a camera with events and frames. events-only: a camera without "
        "frames. pictures: a camera without events.",
    )
    centre_x_px: float | None = _measured(
        0.0, 345.0, "Middle of the gel, from the left of a picture of 346 x 260 px.", "px"
    )
    centre_y_px: float | None = _measured(0.0, 259.0, "The same from its top.", "px")
    px_per_mm: float | None = _measured(
        1.4, 5.7, "Scale in the middle of the gel, of a picture 260 px high.", "px/mm"
    )
    turn_deg: float | None = _measured(
        -180.0, 180.0, "Turn of the gel in the picture, clockwise.", "deg"
    )
    blur_px: float | None = _measured(
        0.0, 4.0, "Standard deviation of the lens's point spread.", "px"
    )
    white_dn: float | None = _measured(
        1.0, 2000.0, "Light of a dot; above 255 it is saturated.", "grey levels"
    )
    black_dn: float | None = _measured(0.0, 255.0, "Light of the gel.", "grey levels")
    read_noise_dn: float | None = _measured(
        0.0, 60.0, "Standard deviation of a dark pixel from frame to frame.", "grey levels"
    )
    frame_us: float | None = _measured(2_000, 1_000_000, "From a frame to the next one.", "us")
    exposure_us: float | None = _measured(500, 1_000_000, "Exposure of a frame.", "us")
    shot_hz: float | None = _measured(
        0.0, 50.0, "Noise of a dark pixel, ON and OFF alike.", "events/s"
    )
    leak_hz: float | None = _measured(0.0, 50.0, "Noise of a pixel that is ON alone.", "events/s")
    hot_pixels: int | None = Field(
        default=None, ge=0, le=5000, description="Pixels that never stop firing."
    )
    hot_hz: float | None = _measured(1.0, 2000.0, "How often each of them fires.", "events/s")
    readout_times: float | None = _measured(
        0.0, 200.0, "Events of reading a frame, in those of the DAVIS-346 that was measured."
    )
    kept_share: float | None = _measured(
        0.0, 0.2, "Share of its largest motion by which a dot stays off after a stroke."
    )
    missing_dots: (
        Annotated[list[Annotated[int, Field(ge=1, le=400)]], Field(max_length=400)] | None
    ) = Field(default=None, description="Numbers of the dots that are not seen, from 1.")

    def configure(self, gel: Gel) -> SimulatorConfig:
        """Returns the simulated set-up with a gel; what was not measured is as usual."""
        usual = SimulatorConfig().show(gel)
        n = gel.n_markers
        missing = tuple(each - 1 for each in self.missing_dots or () if each <= n)
        if self.camera == "pictures":
            usual = replace(usual, uvc=UvcConfig())
        scale = _choose(self.px_per_mm, SHIPPED_RIG.px_per_mm)
        centre = (
            _choose(self.centre_x_px, SHIPPED_RIG.centre_px[0]),
            _choose(self.centre_y_px, SHIPPED_RIG.centre_px[1]),
        )
        rig = Rig(centre, scale, math.radians(_choose(self.turn_deg, 0.0)))
        sensor = usual.sensor
        frame_us = _to_ticks(_choose(self.frame_us, sensor.frame_us))
        exposure_us = _to_ticks(_choose(self.exposure_us, min(sensor.exposure_us, frame_us / 2)))
        return replace(
            usual,
            gel=replace(usual.gel, residue=_choose(self.kept_share, 0.0), missing=missing),
            camera=replace(usual.camera, rig=rig),
            light=replace(
                usual.light,
                white_dn=_choose(self.white_dn, usual.light.white_dn),
                black_dn=_choose(self.black_dn, usual.light.black_dn),
            ),
            sensor=replace(
                sensor,
                blur_px=blur_at_usual_scale(_choose(self.blur_px, sensor.blur_px), scale),
                read_noise_dn=_choose(self.read_noise_dn, sensor.read_noise_dn),
                frame_us=frame_us,
                exposure_us=min(exposure_us, frame_us - TICK_US),
                shot_hz=_choose(self.shot_hz, sensor.shot_hz),
                leak_hz=_choose(self.leak_hz, sensor.leak_hz),
                n_hot=self.hot_pixels or 0,
                hot_hz=_choose(self.hot_hz, sensor.hot_hz),
            ),
        )

    def format(self) -> str:
        """Returns the file: a line for each key that is given, with its unit and its meaning."""
        lines = [_HEAD]
        for name, info in type(self).model_fields.items():
            value = getattr(self, name)
            if value is None:
                continue
            extra = info.json_schema_extra
            unit = f"{extra['x-unit']}. " if isinstance(extra, dict) else ""
            lines.append(f"{name}: {_write(value)}  # {unit}{info.description}\n")
        return "".join(lines)

    def count_measured(self) -> tuple[int, int]:
        """Returns how many settings are given, and how many there could be."""
        names = set(type(self).model_fields) - {"version", "simulated", "camera"}
        return sum(getattr(self, name) is not None for name in names), len(names)

    def list_nuisances(self) -> dict[str, float]:
        """Returns what the simulator has as nuisances, by their names."""
        found = {} if self.readout_times is None else {"readout": self.readout_times}
        return {**found, "frames": 0.0} if self.camera == "events-only" else found


class RigFile(NamedTuple):
    """A rig as its file describes it.

    Attributes:
        settings: the simulator's.
        gel: its gel.
        content: the settings as they are in the file.
    """

    settings: RigSettings
    gel: ChosenGel
    content: bytes


def load_rig(path: Path) -> RigFile:
    """Returns the rig of a file that ``neurotouch hello`` wrote.

    Raises:
        RecordingError: it cannot be read, or it has no settings of the simulator.
        ProfileError: the settings or the gel in it are wrong; every mistake has line and column.
    """
    name = make_printable(str(path))
    hint = "Give a file that 'neurotouch hello' has written, such as camera.hello.zip."
    try:
        parts = read_parts(path, (FILE, GEL_FILE), MAX_SETTINGS_BYTES)
    except OSError as error:
        reason = f"'{name}' cannot be read: {error.strerror}."
        raise RecordingError(reason, hint=suggest_reading(error, hint)) from error
    if FILE not in parts:
        raise RecordingError(f"'{name}' has no {FILE} in it.", hint=hint)
    settings = parse_settings(parts[FILE], f"{name}/{FILE}", RigSettings)
    gel = ChosenGel(PAPER_GEL, b"")
    if GEL_FILE in parts:
        gel = parse_gel(parts[GEL_FILE], f"{name}/{GEL_FILE}")
    return RigFile(settings, gel, parts[FILE])


def _write(value: object) -> str:
    """Returns a value as YAML; of a measured number, four digits."""
    if isinstance(value, bool):
        return str(value).lower()
    return repr(float(f"{value:.4g}")) if isinstance(value, float) else str(value)


def _choose(measured: float | None, usual: float) -> float:
    return usual if measured is None else measured


def _to_ticks(us: float) -> int:
    """Returns a time as a multiple of the time in which the simulator draws pictures."""
    return TICK_US * max(round(us / TICK_US), 1)


def blur_at_usual_scale(blur_px: float, px_per_mm: float) -> float:
    """Returns the blur that the simulator needs: it draws dots at the usual scale, then scales."""
    sigma = math.hypot(blur_px, PIXEL_BLUR_PX) * NOMINAL_PX_PER_MM / px_per_mm
    return math.sqrt(max(sigma**2 - PIXEL_BLUR_PX**2, 0.0))
