"""Sees which event cameras are plugged in, without the library and without touching any."""

from contextlib import suppress
from pathlib import Path
from typing import Final

SYSFS: Final = Path("/sys/bus/usb/devices")
_IDS: Final = frozenset(
    {
        *("152a:8419", "152a:841a"),  # DVXplorer, DAVIS
        *("04b4:00f4", "04b4:00f5"),  # Prophesee EVK
        *("31f7:0003", "31f7:0004"),  # CenturyArks
        "1409:8e00",  # IDS
    }
)
"""Vendor and product of the cameras that the library knows, as its udev rules list them."""
_DAVIS_ID: Final = "152a:841a"


def list_plugged(sysfs: Path = SYSFS) -> frozenset[str]:
    """Returns what is plugged in of the cameras that the library knows, without touching any.

    Returns:
        Vendor, product, port and number of each; another number after every plug.
    """
    found = set()
    for folder in sysfs.iterdir() if sysfs.is_dir() else ():
        with suppress(OSError):  # unplugged while we read
            vendor, product, number = (
                (folder / name).read_text().strip() for name in ("idVendor", "idProduct", "devnum")
            )
            if f"{vendor}:{product}" in _IDS:
                found.add(f"{vendor}:{product} {folder.name} {number}")
    return frozenset(found)


def needs_library(sysfs: Path = SYSFS) -> bool:
    """Returns whether a camera is plugged in that only the library can play."""
    return any(not each.startswith(_DAVIS_ID) for each in list_plugged(sysfs))
