"""Finds the files that come with the program: profiles with their schema, rules, settings."""

from pathlib import Path
from typing import Final, Literal

PACKAGE_FOLDER: Final = Path(__file__).parent

Resource = Literal["profiles", "udev", "modules-load.d", "windows", "desktop"]

_IN_CHECKOUT: Final[dict[Resource, str]] = {
    "profiles": "profiles",
    "udev": "udev",
    "modules-load.d": "packaging/modules-load.d",
    "windows": "packaging/windows",
    "desktop": "packaging/desktop",
}


def find_resources(kind: Resource, package: Path = PACKAGE_FOLDER) -> Path:
    """Returns the folder of a kind of files: inside an installed package, beside it in a checkout.

    Args:
        kind: kind of files.
        package: the folder of the package ``neurotouch_hid``.
    """
    packaged = package / "data" / kind
    return packaged if packaged.is_dir() else package.parent / _IN_CHECKOUT[kind]
