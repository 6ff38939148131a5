"""The running driver: source, pipeline and pad, and everything around them."""

from neurotouch_hid.driver.driver import Driver
from neurotouch_hid.driver.options import DeviceKind, DriverOptions

__all__ = ["DeviceKind", "Driver", "DriverOptions"]
