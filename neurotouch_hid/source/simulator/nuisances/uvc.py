"""A UVC camera instead of the DAVIS, and the defects of such cameras."""

from dataclasses import replace
from typing import Any

from neurotouch_hid.errors import SourceError
from neurotouch_hid.source.simulator.config import UvcConfig
from neurotouch_hid.source.simulator.sensor import TICK_US
from neurotouch_hid.source.simulator.setup import Setup

SHUTTER_SHARE = 0.5  # of the frame period in which a frame is exposed


def uvc(setup: Setup, per_s: float) -> Setup:
    """Takes a UVC camera, which sends ``per_s`` frames a second and no events."""
    frame_us = TICK_US * round(1e6 / per_s / TICK_US)
    exposure_us = TICK_US * max(round(SHUTTER_SHARE * frame_us / TICK_US), 1)
    setup = setup.configured("sensor", frame_us=frame_us, exposure_us=exposure_us)
    return replace(setup, config=replace(setup.config, uvc=UvcConfig()))


def rolling(setup: Setup, ms: float) -> Setup:
    """Exposes each row later than the one above, the last one by ``ms`` ms (rolling shutter)."""
    return _configured(setup, "rolling", readout_us=round(1000 * ms))


def gamma(setup: Setup, exponent: float) -> Setup:
    """Brightens dark pixels: the camera sends light to the power of 1/``exponent``."""
    return _configured(setup, "gamma", gamma=exponent)


def mjpeg(setup: Setup, quality: float) -> Setup:
    """Compresses each frame as a JPEG of quality ``quality``."""
    return _configured(setup, "mjpeg", jpeg_quality=round(quality))


def auto_exposure(setup: Setup, dn: float) -> Setup:
    """Leaves auto exposure on, which brings the mean of the picture to ``dn`` grey levels."""
    return _configured(setup, "auto-exposure", auto_exposure_dn=dn)


def _configured(setup: Setup, name: str, **values: Any) -> Setup:
    """Returns the set-up with other values of its UVC camera.

    Raises:
        SourceError: it has none.
    """
    if setup.config.uvc is None:
        raise SourceError(
            f"The nuisance {name} needs a camera without events.",
            hint="Add uvc before it, as in sim:tour,uvc,rolling, or simulate with --camera uvc.",
        )
    return replace(setup, config=replace(setup.config, uvc=replace(setup.config.uvc, **values)))
