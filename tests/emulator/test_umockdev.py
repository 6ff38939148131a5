"""Real libusb and whole drivers, ours and other people's, on the emulated camera."""

import time

import numpy as np
import pytest
from neurotouch_devtools.emulator import CameraConfig, Fault, Identity

from tests.emulator.comparison import assert_same
from tests.emulator.host import make_scene
from tests.emulator.stage import SCENE, finish, run, start

pytestmark = pytest.mark.filterwarnings("ignore:DynamicImporter:ImportWarning")  # gi's own


@pytest.mark.parametrize("driver", ["neuromorphic", "dv", "own"])
def test_every_driver_sees_what_was_shown(plug, driver, tmp_path):
    out = tmp_path / "seen.npz"
    resets = driver != "neuromorphic"  # the others reset the clock, and show nothing before
    config = CameraConfig(unpaced=True, await_reset=resets, lead_us=700_000 * (not resets))
    run(plug(config), "-m", "tests.emulator.drivers", driver, str(out), "20000", "6", "200")
    assert_same(np.load(out), SCENE)


@pytest.mark.parametrize("orientation", [5, 6, 7])
def test_another_driver_undoes_the_flips_as_we_do_them(plug, orientation, tmp_path):
    config = CameraConfig(unpaced=True, lead_us=700_000, orientation=orientation)
    scene = make_scene(n_events=500, length_us=60_000, n_frames=1)
    out = tmp_path / "seen.npz"
    cable = plug(config, scene=scene)
    run(cable, "-m", "tests.emulator.drivers", "neuromorphic", str(out), "500", "1", "200")
    assert_same(np.load(out), scene)


def test_another_driver_understands_the_motion_sensor(plug):
    script = """
import neuromorphic_drivers
with neuromorphic_drivers.open(iterator_timeout=0.1) as device:
    for _, packet in device:
        if packet is not None and packet.imu_events is not None:
            sample = packet.imu_events[-1]
            print(*(round(float(sample[name]), 1) for name in sample.dtype.names[1:]))
            break
"""
    values = [abs(float(value)) for value in run(plug(), "-c", script).split()]
    assert 9.8 in values
    assert 25.0 in values


def test_the_vendor_s_driver_notices_that_its_camera_is_gone(plug, tmp_path):
    cable = plug()
    arguments = ("-m", "tests.emulator.drivers", "dv", str(tmp_path / "seen.npz"))
    process = start(cable, *arguments, "1000000", "0", "240")
    deadline = time.monotonic() + 120
    while not cable.camera.ended and time.monotonic() < deadline:
        time.sleep(0.05)
    cable.unplug()
    finish(process, timeout_s=120)  # half of the patience it was given
    assert np.load(tmp_path / "seen.npz")["events"].size


PROBE = """
import errno, usb.core, usb.util
device = usb.core.find(idVendor=0x152A, idProduct=0x841A)
print(device.serial_number, device.product, device.speed, f"{device.bcdDevice:04x}")
device.set_configuration(1)
usb.util.claim_interface(device, 0)

def write(module, parameter, value):
    device.ctrl_transfer(0x40, 0xBF, module, parameter, value.to_bytes(4, "big"), 5000)

def attempt(action):
    try:
        return "fine", action()
    except usb.core.USBError as error:
        return errno.errorcode[error.errno], None

"""


def test_libusb_reads_the_descriptors(plug):
    camera = CameraConfig(identity=Identity(serial="00001055", super_speed=False, board=2))
    assert run(plug(camera), "-c", PROBE).split() == ["00001055", "DAVIS", "346", "3", "0206"]


def test_libusb_feels_faults_in_requests(plug):
    faults = map(Fault.parse, ("stall@open+1", "timeout@open+2", "short@open+3", "unplug@open+5"))
    script = PROBE + (
        "ask = lambda: bytes(device.ctrl_transfer(0xC0, 0xBF, 6, 0, 4, 5000)).hex()\n"
        "for _ in range(7): print(*attempt(ask))"
    )
    lines = run(plug(None, *faults), "-c", script).splitlines()[1:]
    assert lines == [
        "fine 00000012",
        "EPIPE None",
        "ETIMEDOUT None",
        "fine 0000",
        "fine 00000012",
        "ENODEV None",
        "ENODEV None",
    ]


def test_libusb_feels_faults_in_transfers(plug):
    faults = [Fault.parse(text) for text in ("protocol+1", "babble+2", "stall+4", "unplug+8")]
    script = PROBE + (
        "for switch in ((0, 3), (9, 0), (0, 1), (0, 0), (1, 3)): write(*switch, 1)\n"
        "read = lambda: len(device.read(0x82, 8192, 60_000))\n"
        "print(*(attempt(read)[0] for _ in range(6)))\n"
        "device.clear_halt(0x82)\n"
        "print(*(attempt(read)[0] for _ in range(5)))"
    )
    first, second = run(plug(None, *faults), "-c", script).splitlines()[1:]
    assert first.split() == ["fine", "EIO", "EOVERFLOW", "fine", "EPIPE", "EPIPE"]
    assert second.split() == ["fine", "fine", "fine", "ENODEV", "ENODEV"]
