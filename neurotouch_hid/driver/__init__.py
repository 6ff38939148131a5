"""The running driver: source, pipeline and pad, and everything around them."""

from typing import TYPE_CHECKING

from neurotouch_hid.driver.options import REFERENCE, DeviceKind, DriverOptions
from neurotouch_hid.lazy import load_lazily

if TYPE_CHECKING:
    from neurotouch_hid.driver.driver import Driver
else:
    __getattr__ = load_lazily(__name__, {"driver": "Driver"})  # which loads every kernel

__all__ = ["REFERENCE", "DeviceKind", "Driver", "DriverOptions"]
