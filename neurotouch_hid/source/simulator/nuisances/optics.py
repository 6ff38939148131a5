"""Place of the camera, and distortion and blur of its lens."""

import math
from dataclasses import replace

from neurotouch_hid.geometry import NOMINAL_PX_PER_MM
from neurotouch_hid.source.simulator.optics import PIXEL_BLUR_PX
from neurotouch_hid.source.simulator.setup import Setup


def lens(setup: Setup, percent: float) -> Setup:
    """Moves the dots at the rim out by ``percent`` % (pincushion), or in if negative (barrel)."""
    camera = setup.config.camera
    radius_mm = setup.config.gel.layout.radius_mm
    seen2 = (radius_mm * (camera.distance_mm + camera.height_mm) / camera.distance_mm) ** 2
    barrel = (1.0 - (1.0 - camera.barrel * seen2) * (1.0 + 0.01 * percent)) / seen2
    return setup.configured("camera", barrel=barrel)


def fisheye(setup: Setup, degrees: float) -> Setup:
    """Takes a wide lens (equidistant), which sees the gel under ``degrees``°."""
    return setup.configured("camera", fisheye_rad=0.5 * math.radians(degrees))


def tilt(setup: Setup, degrees: float) -> Setup:
    """Leans the camera over, so that one side of the gel is nearer."""
    return setup.configured("camera", tilt_rad=math.radians(degrees))


def blur(setup: Setup, px: float) -> Setup:
    """Sets the point spread of a lens out of focus."""
    return setup.configured("sensor", blur_px=px)


def scale(setup: Setup, px_per_mm: float) -> Setup:
    """Sets how large the gel is in the picture; the blur of the lens stays the same in pixels."""
    # The profile of a marker is made for the usual size, so that it needs another blur there.
    sensor = setup.config.sensor
    grown = NOMINAL_PX_PER_MM / px_per_mm
    sigma = math.hypot(sensor.blur_px, PIXEL_BLUR_PX) * grown
    blur_px = math.sqrt(max(sigma**2 - PIXEL_BLUR_PX**2, 0.0))
    rig = replace(setup.config.camera.rig, px_per_mm=px_per_mm)
    return setup.configured("camera", rig=rig).configured("sensor", blur_px=blur_px)


def rotation(setup: Setup, degrees: float) -> Setup:
    """Turns the camera about its axis."""
    rig = setup.config.camera.rig
    turned = replace(rig, rotation_rad=rig.rotation_rad + math.radians(degrees))
    return setup.configured("camera", rig=turned)


def decentring(setup: Setup, px: float) -> Setup:
    """Moves the gel in the picture to the right."""
    rig = setup.config.camera.rig
    moved = replace(rig, centre_px=(rig.centre_px[0] + px, rig.centre_px[1]))
    return setup.configured("camera", rig=moved)
