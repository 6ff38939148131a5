"""Emulated cameras that real libusb sees."""

import pytest
from neurotouch_devtools.emulator import CameraConfig, EmulatedCamera

from tests.emulator.stage import SCENE, plug_in


@pytest.fixture
def plug():
    """Returns what plugs a camera in; skips where umockdev is not installed."""
    cables = []

    def plug(config=None, *faults, scene=SCENE):
        camera = EmulatedCamera(
            scene, config or CameraConfig(unpaced=True, lead_us=700_000), faults
        )
        cables.append(plug_in(camera))
        return cables[-1]

    yield plug
    for cable in cables:
        cable.close()
