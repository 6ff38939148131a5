"""Finds settings with which the simulator shows what was measured of a rig."""

import math
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.doctor.hello.dot_light import measure_dot_light
from neurotouch_hid.doctor.hello.rig_settings import CameraKind, RigSettings, blur_at_usual_scale
from neurotouch_hid.geometry import Gel, fit_rig
from neurotouch_hid.source.simulator.config import SimulatorConfig
from neurotouch_hid.source.simulator.optics import CameraModel, marker_profile

Figures = Mapping[str, float | None]

_DOT_PER_WHITE: Final = 0.8
"""Measured light of dots, of ``white_dn`` over the gel: they lean, and light falls off to the
rim."""
_GROUND_PER_BLACK: Final = 0.937
_SEEN_PER_SHOT: Final = 0.976
"""Share of ``shot_hz`` that is measured: bright pixels fire less."""
_PEAK: Final = 0.95
"""Peak of a drawn dot, of that of a dot on the dome, each over the light of all of it."""
_MOST_DN: Final = 240.0
_LEAST_LEAK: Final = 0.05
"""Of the noise; less cannot be told from chance."""
_USUAL_BLUR_PX: Final = 0.6
_PHOTONS: Final = 1.0 / 80.0
"""Variance of a pixel's light, of its light."""
_ROUNDING: Final = 1.0 / 12.0
"""Variance that rounding to whole grey levels adds."""


def fit_rig_settings(
    figures: Figures,
    gel: Gel,
    missing: tuple[int, ...],
    *,
    camera: CameraKind,
    is_simulated: bool,
) -> RigSettings | None:
    """Returns the simulator's settings of a rig; None if nothing was measured.

    A figure that is not known gives no setting. Nor does one that is beyond what the simulator can
    show.

    Args:
        figures: what was measured, as of ``Session.list_figures``.
        gel: the gel.
        missing: dots that were not seen, as places in ``Gel.points_mm``.
        camera: what the camera sends.
        is_simulated: the rig was a simulation.
    """
    blur_px = _fit_blur(figures, gel)
    found: dict[str, Any] = {
        "centre_x_px": figures.get("centre_x_px"),
        "centre_y_px": figures.get("centre_y_px"),
        "px_per_mm": _fit_scale(figures, gel),
        "turn_deg": figures.get("fitted_turn_deg"),
        "blur_px": blur_px,
        **_fit_light(figures, gel, blur_px),
        "read_noise_dn": _fit_read_noise(figures),
        "frame_us": figures.get("frame_period_us"),
        "exposure_us": figures.get("exposure_us"),
        **_fit_noise(figures),
        "readout_times": figures.get("readout_times"),
        "kept_share": _not_below_zero(figures.get("kept_share")),
    }
    hot = figures.get("hot_pixels")
    if hot is not None:
        found["hot_pixels"], found["hot_hz"] = round(hot), figures.get("hot_hz")
    if figures.get("dots_missing") is not None:
        found["missing_dots"] = [each + 1 for each in missing]
    known = {name: value for name, value in found.items() if _is_possible(name, value)}
    if not known:
        return None
    return RigSettings(simulated=is_simulated, camera=camera, **known)


def _is_possible(name: str, value: Any) -> bool:
    """Returns whether the simulator can show a value."""
    if value is None or isinstance(value, list):
        return value is not None
    limits = RigSettings.model_fields[name].metadata
    least = next(each.ge for each in limits if hasattr(each, "ge"))
    most = next(each.le for each in limits if hasattr(each, "le"))
    return bool(least <= value <= most)


def _not_below_zero(value: float | None) -> float | None:
    return None if value is None else max(value, 0.0)


def _fit_scale(figures: Figures, gel: Gel) -> float | None:
    """Returns the scale in the middle: over the whole dome, the usual lens shows a little more."""
    fitted = figures.get("fitted_px_per_mm")
    if fitted is None:
        return None
    config = SimulatorConfig().show(gel).camera
    points_mm = np.column_stack([gel.points_mm, np.zeros(gel.n_markers)])
    shown = fit_rig(CameraModel(config, gel).project(points_mm), gel)
    return fitted * config.rig.px_per_mm / shown.px_per_mm


def _fit_noise(figures: Figures) -> dict[str, float]:
    """Returns the rates of noise of both polarities alike, and of ON alone (the leak).

    Noise of either kind sets a pixel back. So with noise ``s`` and a leak ``l`` alone, a pixel
    leaks only s / (exp(s / l) - 1) times a second.
    """
    on, off = figures.get("quiet_on_hz_per_px"), figures.get("quiet_off_hz_per_px")
    if on is None or off is None:
        return {}
    noise, leaked = 2.0 * off, on - off
    rates = {"shot_hz": noise / _SEEN_PER_SHOT}
    if leaked > _LEAST_LEAK * (on + off):
        rates["leak_hz"] = noise / math.log1p(noise / leaked) if noise else leaked
    return rates


def _fit_read_noise(figures: Figures) -> float | None:
    """Returns the noise of reading a pixel, without that of the light and of rounding."""
    seen, ground = figures.get("frame_noise_dn"), figures.get("ground_dn")
    if seen is None or ground is None:
        return None
    return math.sqrt(max(seen**2 - _PHOTONS * ground - _ROUNDING, 0.0))


def _fit_blur(figures: Figures, gel: Gel) -> float | None:
    """Returns the point spread: how much less the peak of a dot is than the light of all of it.

    None if white is cut off, so that nobody knows the peak.
    """
    dot, ground = figures.get("dot_dn"), figures.get("ground_dn")
    peak, scale = figures.get("peak_dn"), figures.get("fitted_px_per_mm")
    if not dot or ground is None or peak is None or scale is None or peak + ground > _MOST_DN:
        return None
    blurs = np.arange(0.0, 4.05, 0.1)
    drawn = [measure_dot_light(*_draw_dots(each, gel, scale), scale, gel) for each in blurs]
    shares = np.array([math.inf if each is None else each.peak_dn / each.dot_dn for each in drawn])
    return float(np.interp(-_PEAK * peak / dot, -shares, blurs))


def _fit_light(figures: Figures, gel: Gel, blur_px: float | None) -> dict[str, float]:
    """Returns the light of dots and gel.

    A blurred dot reaches beyond the place where its light is measured; of a drawn one this is
    known.
    """
    dot, ground = figures.get("dot_dn"), figures.get("ground_dn")
    scale = figures.get("fitted_px_per_mm")
    if dot is None or ground is None or scale is None:
        return {}
    usual, now = (
        measure_dot_light(*_draw_dots(each, gel, scale), scale, gel)
        for each in (_USUAL_BLUR_PX, _USUAL_BLUR_PX if blur_px is None else blur_px)
    )
    if usual is None or now is None:
        return {}
    over = dot / _DOT_PER_WHITE * usual.dot_dn / now.dot_dn
    black = max(ground - over * (now.ground_dn - usual.ground_dn), 0.0) / _GROUND_PER_BLACK
    return {"white_dn": over + black, "black_dn": black}


def _draw_dots(
    blur_px: float, gel: Gel, px_per_mm: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns a picture of 5 x 5 dots of light 1 on a dark gel, and their places, (25, 2) px."""
    profile, steps = marker_profile(blur_at_usual_scale(blur_px, px_per_mm), gel.dot_mm)
    radius = 0.5 * gel.dot_mm * px_per_mm
    pitch = math.floor(gel.pitch_mm * px_per_mm) + 0.2  # so that dots are on and between pixels
    pixels = np.arange(math.ceil(6.0 * pitch) + 1.0)
    places = np.array([(x * pitch, y * pitch) for y in range(1, 6) for x in range(1, 6)])
    picture = np.zeros((len(pixels), len(pixels)))
    for x, y in places:
        square = ((pixels[:, None] - y) ** 2 + (pixels - x) ** 2) / radius**2
        picture += np.interp(square * steps, np.arange(len(profile)), profile)
    return picture, places
