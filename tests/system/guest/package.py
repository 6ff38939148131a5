"""Rights by ``neurotouch setup``, then the package: put in, renewed, taken out."""

import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from tests.system.guest.camera import PACE
from tests.system.guest.desk import Desk
from tests.system.guest.installing import choose_processor, lay_kernels
from tests.system.guest.observation import (
    D_PAD,
    GEAR,
    PLAYER,
    SERVICE,
    describe_node,
    find_pad,
    main_pid,
    read_exposure,
    read_status,
    run,
    run_as,
    show,
    wait_for,
)

_OPEN = "import os, sys; os.close(os.open(sys.argv[1], os.O_RDWR))"
_CACHE = Path("/var/cache/neurotouch")
_VALUES = Path("/etc/neurotouch/user.yaml")
_PROFILES = Path("/etc/neurotouch/profiles")
_PLACES = ("/etc", "/usr", "/var", "/run", "-xdev", "-name", "*neurotouch*")
_LEAVING_OUT = ("-not", "-path", "/var/cache/apt/*", "-not", "-path", "/var/log/*")


def set_up(desk: Desk) -> dict[str, Any]:
    """``neurotouch setup`` out of the checkout, for who installs with pip; then taken back."""
    desk.camera.plug()
    camera = wait_for(find_camera)
    nodes = ("/dev/uinput", camera)

    def setup(*options: str) -> dict[str, Any]:
        said = subprocess.run(
            [sys.executable, "-m", "neurotouch_hid", "setup", *options],
            capture_output=True,
            text=True,
            check=False,
        )
        return {"code": said.returncode, "out": said.stdout, "err": said.stderr}

    saw = {"before": find_allowed(*nodes), "dry_run": setup("--dry-run")}
    saw |= {"after_dry_run": find_allowed(*nodes)}
    saw |= {"installed": setup("--yes"), "after": find_allowed(*nodes)}
    saw |= {"uninstalled": setup("--uninstall", "--yes"), "in_the_end": find_allowed(*nodes)}
    desk.camera.pull()
    saw["left"] = [str(path) for path in Path("/etc").rglob("*neurotouch*")]
    return saw


def install(desk: Desk) -> dict[str, Any]:
    """``apt install`` while the camera is in: no other command, and the pad is there."""
    if desk.camera is None:
        return _install_aloud(desk)
    choose_processor()
    # A quarter of the packets, half the work of the emulated camera; and so this file is read.
    Path("/etc/neurotouch").mkdir()
    Path("/etc/neurotouch/camera.yaml").write_text("version: 1\nearly_packet_delay_us: 1000\n")
    lay_kernels(desk.results)
    desk.camera.plug()
    wait_for(find_camera)
    done = _install_aloud(desk)
    begun = time.monotonic()
    pad = wait_for(find_pad)
    waited_s = time.monotonic() - begun
    wait_for(lambda: show("ActiveState")["ActiveState"] == "active")
    return {**done, "pad": pad, "waited_s": waited_s, "journal": _read_journal()}


def _install_aloud(desk: Desk) -> dict[str, Any]:
    """What apt says, and which kernels were compiled meanwhile."""
    before = {*_CACHE.rglob("*.code")}
    done = _install(desk)
    return {"apt": done, "compiled": [path.name for path in {*_CACHE.rglob("*.code")} - before]}


def _install(desk: Desk) -> dict[str, Any]:
    return run("apt-get", "install", "--yes", str(desk.package))


def look_at_rights(desk: Desk) -> dict[str, Any]:
    """What the service may do, and what anybody else may while it plays."""
    saw = {
        "exposure": read_exposure(SERVICE),
        "failed_units": run("systemctl", "--failed", "--no-legend", "--plain")["out"],
    }
    return saw if desk.camera is None else saw | _look_while_it_plays()


def _look_while_it_plays() -> dict[str, Any]:
    wait_for(lambda: run_as(PLAYER, "test", "-r", find_pad() or "")["code"] == 0, 30)
    pid, camera = main_pid(), find_camera() or ""
    status = read_status(pid)
    return {
        "show": show("User", "Type", "NRestarts", "SubState", "StatusText", "OpenFile"),
        "status": {name: status[name] for name in ("Uid", "CapEff", "NoNewPrivs", "Seccomp")},
        "uinput": describe_node("/dev/uinput"),
        "camera": {
            **describe_node(camera),
            "group": run("stat", "-c", "%G", camera)["out"].strip(),
        },
        "pad": describe_node(find_pad() or ""),
        "player": find_allowed("/dev/uinput", camera),
        "holds": sorted({_read_link(link) for link in Path(f"/proc/{pid}/fd").iterdir()}),
    }


def upgrade(desk: Desk) -> dict[str, Any]:
    """The same package once more, while it plays: what dpkg does with a newer one.

    The machine has values and a profile for everybody, as an existing installation does.
    """
    shipped = _VALUES.read_text()
    _PROFILES.mkdir()
    racing = run("neurotouch", "profile", "export", "racing")["out"]
    gears = _PROFILES / "gears.yaml"
    gears.write_text(racing.replace("name: racing", "name: gears"))
    _VALUES.write_text("version: 1\nfilter: light\nslots: [gears]\n")
    saw = {"code": _reinstall(desk).wait(600)} if desk.camera is None else _renew(desk)
    saw["kept"] = {"values": _VALUES.read_text(), "profile": gears.exists()}
    if desk.camera is not None:
        saw |= _choose(desk)
    gears.unlink()
    _PROFILES.rmdir()
    _VALUES.write_text(shipped)
    if desk.camera is not None:
        run("systemctl", "restart", SERVICE)
        desk.play_until_pushed()
    return saw


def change_versions(desk: Desk) -> dict[str, Any]:
    """An older version in place of this one, then this one again; the machine has values."""
    shipped = _VALUES.read_text()
    _VALUES.write_text("version: 1\nfilter: light\n")
    saw = {}
    packages = {"older": next(desk.results.glob("older/*.deb")), "newer": desk.package}
    for name, package in packages.items():
        done = run("apt-get", "install", "--yes", "--allow-downgrades", str(package))
        version = run("dpkg-query", "--showformat=${Version}", "--show", "neurotouch-hid")["out"]
        saw[name] = {"apt": done, "version": version, "values": _VALUES.read_text()}
        saw[name]["runs"] = run("neurotouch", "profile", "check")
        if desk.camera is not None:
            desk.play_until_pushed()
    _VALUES.write_text(shipped)
    return saw


def _reinstall(desk: Desk) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        ["apt-get", "install", "--yes", "--reinstall", str(desk.package)],
        stdin=subprocess.DEVNULL,
        stdout=(desk.results / "upgrade.txt").open("w"),
        stderr=subprocess.STDOUT,
        env={**os.environ, "DEBIAN_FRONTEND": "noninteractive"},
    )


def _renew(desk: Desk) -> dict[str, Any]:
    """While it plays, at half the pace: else dpkg would get a quarter of the one processor."""
    run("systemctl", "restart", SERVICE)
    desk.camera.plug(pace=PACE / 2)
    reader = desk.read_pad()
    wait_for(lambda: GEAR in reader.pressed())
    before = desk.identity()
    done = _reinstall(desk)
    wait_for(lambda: reader.ended, 900)
    gone_s = time.monotonic()
    wait_for(find_pad)
    back_s = time.monotonic()
    saw = {"code": done.wait(600), "gap_s": back_s - gone_s}
    saw |= {"new_process": before[1] != main_pid()}
    saw |= {"left_pressed": [list(control) for control in reader.pressed() if control[0] == 1]}
    return saw


def _choose(desk: Desk) -> dict[str, Any]:
    """The person at the machine saves a choice of their own."""
    desk.camera.plug()
    reader = desk.read_pad()
    wait_for(lambda: GEAR in reader.pressed())
    saw = {"used": run_as(PLAYER, "neurotouch", "profile", "use", "platformer")}
    wait_for(lambda: D_PAD in reader.pressed())
    saw["own"] = run_as(PLAYER, "cat", f"/home/{PLAYER}/.config/neurotouch/user.yaml")["out"]
    saw["machine_after"] = _VALUES.read_text()
    desk.forget_choice()
    return saw


def purge(desk: Desk) -> dict[str, Any]:
    """Everything taken out again, with the camera in."""
    camera = find_camera() if desk.camera else None
    own = (
        _CACHE,
        Path("/etc/neurotouch"),
        Path("/run/neurotouch"),
        Path("/usr/lib/neurotouch-hid"),
    )
    installed = run("dpkg", "-L", "neurotouch-hid")["out"].splitlines()
    done = run("apt-get", "purge", "--yes", "neurotouch-hid")
    run("udevadm", "settle")
    files = [path for path in installed if Path(path).is_file()]
    saw = {
        "apt": done,
        "files": files,
        "folders": [str(path) for path in own if path.exists()],
        "pads": [find_pad(), find_pad(player=2)],
        "user": run("getent", "passwd", "neurotouch")["out"],
        "units": run("systemctl", "list-units", "--all", "--no-legend", "--plain", "neurotouch*")[
            "out"
        ],
        "anywhere": run("find", *_PLACES, *_LEAVING_OUT)["out"].split(),
    }
    if camera:
        saw |= {"uinput": describe_node("/dev/uinput"), "camera": describe_node(camera)}
        saw["still_plugged"] = bool(find_camera())
    return saw


def find_allowed(*nodes: str) -> dict[str, bool]:
    """Which of the nodes the player may open, by path."""
    return {node: run_as(PLAYER, "python3", "-c", _OPEN, node)["code"] == 0 for node in nodes}


def find_camera() -> str | None:
    """The camera's node."""
    for vendor in Path("/sys/bus/usb/devices").glob("*/idVendor"):
        try:
            if vendor.read_text().strip() == "152a":
                numbers = [int(vendor.with_name(n).read_text()) for n in ("busnum", "devnum")]
                node = Path("/dev/bus/usb/{:03d}/{:03d}".format(*numbers))
                return str(node) if node.exists() else None
        except OSError:
            continue
    return None


def _read_journal() -> str:
    said = run("journalctl", "--unit", SERVICE, "--no-pager", "--output=short-monotonic")["out"]
    return said[-4000:]


def _read_link(link: Path) -> str:
    try:
        return str(link.readlink())
    except OSError:
        return ""
