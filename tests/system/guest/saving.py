"""Saves a profile over and over on a disk of its own, until the power is cut.

    python -m tests.system.guest.saving RESULTS TURN

Runs in a guest. First it writes what it finds on the disk after the cut before, then it saves. The
host is told of each save that has ended, through a folder that no cut reaches.
"""

import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

DISK, PLACE = "/dev/vda", Path("/tmp/disk")
NAME = "mine"


def main() -> None:
    results, turn = Path(sys.argv[1]), int(sys.argv[2])
    (results / "booted").touch()
    PLACE.mkdir()
    subprocess.run(["modprobe", "-a", "virtio_blk", "ext4"], check=True)
    while not Path(DISK).exists():
        time.sleep(0.1)
    subprocess.run(["mount", "-t", "ext4", DISK, str(PLACE)], check=True)
    os.environ["XDG_CONFIG_HOME"] = str(PLACE)
    (results / f"found{turn}.json").write_text(json.dumps(look()))
    save(results / f"saved{turn}", 1000 * turn)


def look() -> dict[str, Any]:
    """What is left of the profile and its versions."""
    from neurotouch_hid.profile import load_profile
    from neurotouch_hid.profile.editing import take_profile

    folder = PLACE / "neurotouch/profiles"
    if not (folder / f"{NAME}.yaml").exists():
        return {"profile": None, "versions": [], "others": []}
    edited = take_profile(NAME, lambda: "now")
    versions = [each.read().decode() for each in edited.store.versions()]
    return {
        "profile": load_profile(NAME).description,
        "versions": versions,
        "others": sorted(path.name for path in folder.iterdir() if path.suffix != ".yaml"),
    }


def save(told: Path, first: int) -> None:
    """Saves without end; each description is one more than the last."""
    from neurotouch_hid.profile.editing import make_profile, set_value, take_profile

    if not (PLACE / f"neurotouch/profiles/{NAME}.yaml").exists():
        edited = make_profile(NAME, "racing", lambda: "now")
        edited.save(edited.text)
    with told.open("a") as file:
        number = first
        while True:
            edited = take_profile(NAME, lambda: "now")
            edited.save(set_value(edited.text, "description", str(number)))
            print(number, file=file, flush=True)
            number += 1


if __name__ == "__main__":
    main()
