"""Checks video cameras: which there are, and how well one sends its pictures."""

from typing import Final

from neurotouch_hid.doctor.finding import Finding, approve, fail, skip, warn
from neurotouch_hid.geometry import PAPER_GEL, Gel
from neurotouch_hid.source.video.enumeration import find_video_cameras
from neurotouch_hid.source.video.live import VideoStats
from neurotouch_hid.source.video.view_search import find_scale

FAST_MM_S: Final = 100.0
"""Speed of a hand that plays fast."""
_LEAST_RATE: Final = 0.9
"""Share of the wanted rate below which a camera is too slow."""
_MOST_LOST: Final = 0.05
"""Share of pictures; while the gel is searched for, some are lost."""
_MOST_BLUR_PX: Final = 3.0
"""Blur at that speed with which dots, 10 px apart, are still told apart."""


def check_video_cameras() -> Finding:
    """Lists the video cameras that are plugged in, and says whether this person may open them."""
    cameras = find_video_cameras()
    if not cameras:
        return skip("No video camera is plugged in.")
    usable = [info for info in cameras if not info.reason]
    if not usable:
        info = cameras[0]
        return warn(
            f"The video camera {info} cannot be used: {info.reason}.",
            "Log in at the machine itself, or give your user the group 'video' and log in again.",
            'sudo usermod -aG video "$(id -un)"',
        )
    names = ", ".join(map(str, usable))
    return approve(
        f"Plugged in: {names}. To check one with a gel: "
        f"neurotouch doctor --source video:{usable[0].place}"
    )


def judge_pictures(source: str, stats: VideoStats, gel: Gel = PAPER_GEL) -> Finding:
    """Judges the pictures of a camera that has just played.

    Args:
        source: its name.
        stats: what it counted.
        gel: the gel before it; of a small one, the pipeline sees a mm larger.
    """
    mode, px_per_mm = stats.mode, find_scale(gel)
    exposure = _describe_exposure(stats.exposure_us, px_per_mm)
    if mode is None or not stats.fps:
        reason = f" {stats.trouble}" if stats.trouble else ""
        return fail(f"No pictures from {source}.{reason}", "Unplug it and plug it in again.")
    sentence = (
        f"{source}: {mode.width}x{mode.height} {mode.fourcc}, {stats.fps:.0f} of {mode.fps:.0f} "
        f"pictures/s; {exposure}; from its stamp to the driver "
        f"{1e-3 * stats.latency_us:.1f} ms; {stats.n_lost} pictures lost, {stats.n_damaged} "
        f"damaged, {stats.n_pictures} read."
    )
    n_missing = stats.n_lost + stats.n_damaged
    if n_missing > _MOST_LOST * (stats.n_pictures + n_missing):
        return warn(sentence, "Close other programs; use another USB socket or cable.")
    if stats.fps < _LEAST_RATE * mode.fps:
        return warn(
            sentence, "More light, a shorter exposure_us in camera.yaml, or another USB socket."
        )
    if stats.exposure_us is not None and _blur_px(stats.exposure_us, px_per_mm) > _MOST_BLUR_PX:
        return warn(sentence, "More light, and a shorter exposure_us in camera.yaml.")
    if stats.lacking:
        return warn(f"{sentence} {' '.join(stats.lacking)}", "Another camera would play better.")
    return approve(sentence)


def _describe_exposure(exposure_us: int | None, px_per_mm: float) -> str:
    if exposure_us is None:
        return "exposure unknown"
    return (
        f"exposure {1e-3 * exposure_us:g} ms, "
        f"which blurs {_blur_px(exposure_us, px_per_mm):.1f} px at "
        f"{FAST_MM_S:.0f} mm/s"
    )


def _blur_px(exposure_us: int, px_per_mm: float) -> float:
    """Returns how far a dot of a fast hand moves within an exposure, in the pipeline's px."""
    return 1e-6 * exposure_us * FAST_MM_S * px_per_mm
