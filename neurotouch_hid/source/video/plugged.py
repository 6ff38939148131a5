"""Sees which webcams are plugged in, without opening any."""

from contextlib import suppress
from pathlib import Path
from typing import Final

SYSFS: Final = Path("/sys/class/video4linux")


def list_webcams(sysfs: Path = SYSFS) -> tuple[Path, ...]:
    """Returns the device nodes of the video cameras at the USB, by number.

    Of each camera only the first node counts: the others carry its metadata. Codecs and cards for
    television are no webcams.

    Args:
        sysfs: the folder in which Linux lists video devices.
    """
    found = []
    for folder in sysfs.glob("video*") if sysfs.is_dir() else ():
        with suppress(OSError, ValueError):  # unplugged while we read
            place = (folder / "device").resolve(strict=True)
            is_first = int((folder / "index").read_text()) == 0
            if is_first and any(part.startswith("usb") for part in place.parts):
                found.append(int(folder.name.removeprefix("video")))
    return tuple(Path(f"/dev/video{number}") for number in sorted(found))
