"""The running driver: source, pipeline and pad, and everything around them."""

from typing import TYPE_CHECKING, Any

from neurotouch_hid.driver.options import REFERENCE, DeviceKind, DriverOptions

if TYPE_CHECKING:
    from neurotouch_hid.driver.driver import Driver

__all__ = ["REFERENCE", "DeviceKind", "Driver", "DriverOptions"]


def __getattr__(name: str) -> Any:
    if name != "Driver":
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    from neurotouch_hid.driver.driver import Driver  # noqa: PLC0415  # loads every kernel

    return Driver
