"""What an administrator may add: another player's service, rights to play along, a HID pad."""

import re
import shutil
from pathlib import Path
from typing import Any

from evdev import AbsInfo, UInput, ecodes

from tests.system.guest.camera import SERIAL
from tests.system.guest.desk import Desk
from tests.system.guest.observation import (
    PLAYER,
    SERVICE,
    Reader,
    describe_node,
    find_pad,
    read_exposure,
    run,
    run_as,
    show,
    wait_for,
)

OTHER_SERVICE = "neurotouch@2.service"
OTHER_SERIAL = "00000002"

_SETTINGS = Path("/etc/neurotouch")
_EXAMPLES = Path("/usr/share/doc/neurotouch-hid/examples")
_ADDED = {
    "copilot.conf": Path("/etc/systemd/system/neurotouch.service.d"),
    "hid.conf": Path("/etc/systemd/system/neurotouch.service.d"),
    "70-neurotouch-copilot.rules": Path("/etc/udev/rules.d"),
}
_B = ecodes.EV_KEY, ecodes.BTN_EAST
"""What the gel's push does not press."""
_HELPER = "Helper pad"


def play_second(desk: Desk) -> dict[str, Any]:
    """Another player's service, with a camera and a pad of its own; it stays enabled."""
    own = _SETTINGS / "player-2"
    own.mkdir()
    shutil.copy(_SETTINGS / "camera.yaml", own)
    (own / "service.yaml").write_text(f'version: 1\ncamera: "{OTHER_SERIAL}"\n')
    ours = _SETTINGS / "service.yaml"
    before = ours.read_text()
    ours.write_text(f'version: 1\ncamera: "{SERIAL}"\n')
    try:
        return _play_in_turns(desk)
    finally:
        ours.write_text(before)


def _play_in_turns(desk: Desk) -> dict[str, Any]:
    run("systemctl", "restart", SERVICE)
    desk.camera.plug(SERIAL)
    first = desk.play_until_pushed()
    saw: dict[str, Any] = {"first": desk.identity()}
    saw["enabled"] = run("systemctl", "enable", "--now", OTHER_SERVICE)
    saw["show"] = show("ActiveState", "User", "NRestarts", service=OTHER_SERVICE)
    saw["exposure"] = read_exposure(OTHER_SERVICE)
    second = Reader(wait_for(lambda: find_pad(player=2)))
    saw["quiet_without_camera"] = second.is_neutral()
    desk.camera.plug(OTHER_SERIAL)
    wait_for(second.is_pushed)
    saw["first_quiet"] = first.is_neutral() and first.ended is None
    theirs = ("env", "NEUROTOUCH_PLAYER=2", "neurotouch")
    saw["paused"] = run_as(PLAYER, *theirs, "pause")
    wait_for(second.is_neutral)
    saw["first_paused"] = "paused" in run_as(PLAYER, "neurotouch", "status")["out"]
    saw["resumed"] = run_as(PLAYER, *theirs, "resume")
    wait_for(second.is_pushed)
    desk.camera.plug(SERIAL)
    wait_for(second.is_neutral)
    wait_for(first.is_pushed)
    saw["second_quiet"] = second.is_neutral() and second.ended is None
    saw["first_in_the_end"] = desk.identity()
    saw["uinput"] = describe_node("/dev/uinput")
    return saw


def start_together(desk: Desk) -> dict[str, Any]:
    """Three players' services start at the same moment, as they do with the machine."""
    services = {1: SERVICE, 2: OTHER_SERVICE, 3: "neurotouch@3.service"}
    added = [folder for p in (2, 3) if not (folder := _SETTINGS / f"player-{p}").exists()]
    for folder in added:
        folder.mkdir()
        serial = folder.name[-1].zfill(len(OTHER_SERIAL))
        (folder / "service.yaml").write_text(f'version: 1\ncamera: "{serial}"\n')
    run("systemctl", "stop", *services.values())
    saw: dict[str, Any] = {"started": run("systemctl", "start", *services.values())}
    saw["pads"] = {p: wait_for(lambda p=p: find_pad(player=p)) for p in services}
    saw["show"] = {
        p: show("ActiveState", "NRestarts", "Result", service=each) for p, each in services.items()
    }
    saw["uinput"] = describe_node("/dev/uinput")
    desk.play_until_pushed()
    run("systemctl", "stop", services[3])
    for folder in added:
        shutil.rmtree(folder)
    return saw


def add_examples(desk: Desk) -> dict[str, Any]:
    """The examples of the documentation put where it says: a HID pad, and somebody plays along."""
    for name, folder in _ADDED.items():
        folder.mkdir(exist_ok=True)
        shutil.copy(_EXAMPLES / name, folder)
    ours, driver = _SETTINGS / "service.yaml", _SETTINGS / "driver.yaml"
    before = ours.read_text()
    ours.write_text("version: 1\ndevice: hid\n")
    driver.write_text("version: 1\ncopilot:\n  device: auto\n")
    try:
        return _play_along(desk)
    finally:
        ours.write_text(before)
        driver.unlink()
        for name, folder in _ADDED.items():
            (folder / name).unlink()
        _ADDED["copilot.conf"].rmdir()
        _read_files_again()


def _play_along(desk: Desk) -> dict[str, Any]:
    _read_files_again()
    saw: dict[str, Any] = {"restarted": run("systemctl", "restart", SERVICE)}
    reader = desk.play_until_pushed()
    stick = AbsInfo(0, -32768, 32767, 0, 0, 0)
    controls = {
        ecodes.EV_KEY: [ecodes.BTN_SOUTH, ecodes.BTN_EAST],
        ecodes.EV_ABS: [(ecodes.ABS_X, stick), (ecodes.ABS_Y, stick)],
    }
    helper = UInput(controls, name=_HELPER, phys="usb-0000:00:14.0-1/input0")
    node = wait_for(_find_helper)
    helper.write(*_B, 1)
    helper.syn()
    wait_for(lambda: _B in reader.pressed())
    wait_for(reader.is_pushed)
    saw["both"] = _B in reader.pressed()
    saw |= {
        "name": (Path("/sys/class/input") / Path(reader.node).name / "device/name").read_text(),
        "nodes": {node: describe_node(node) for node in ("/dev/uhid", "/dev/uinput")},
        "player_reads_helper": run_as(PLAYER, "test", "-r", node)["code"] == 0,
        "exposure": read_exposure(SERVICE),
    }
    helper.close()
    wait_for(lambda: _B not in reader.pressed())
    return saw


def _find_helper() -> str | None:
    """The node of the pad that plays along, once it does."""
    found = re.search(rf"co-pilot: {_HELPER} \((\S+)\)", run("neurotouch", "status")["out"])
    return found[1] if found else None


def _read_files_again() -> None:
    run("systemctl", "daemon-reload")
    run("udevadm", "control", "--reload")
