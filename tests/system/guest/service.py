"""The service at work: seen by a game, ordered about, its camera pulled and plugged."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from tests.system.guest.desk import Desk
from tests.system.guest.observation import (
    PLAYER,
    SERVICE,
    find_pad,
    main_pid,
    run,
    run_as,
    show,
    wait_for,
)

N_STORM = 12


def play(desk: Desk) -> dict[str, Any]:
    """A game of the ordinary user sees the pad and reads it."""
    reader = desk.read_pad()
    uid_environment = {**os.environ, "SDL_VIDEODRIVER": "dummy", "HOME": f"/home/{PLAYER}"}
    game = subprocess.run(
        ["runuser", "-u", PLAYER, "--", sys.executable, "-m", "tests.system.guest.game", "12"],
        capture_output=True,
        text=True,
        check=False,
        env=uid_environment,
        timeout=600,
    )
    wait_for(reader.is_pushed)
    status = run("neurotouch", "status", "--json")
    return {
        "game": json.loads(game.stdout) if game.returncode == 0 else game.stderr,
        "events": len(reader.events),
        "status": json.loads(status["out"]) if status["code"] == 0 else status,
    }


def order(desk: Desk) -> dict[str, Any]:
    """The user at the seat pauses and resumes the service; others may not."""
    reader = desk.play_until_pushed()
    saw: dict[str, Any] = {"paused": run_as(PLAYER, "neurotouch", "pause")}
    wait_for(reader.is_neutral, 30)
    time.sleep(3.0)
    saw["quiet"] = reader.is_neutral()
    saw["status"] = run_as(PLAYER, "neurotouch", "status")
    saw["resumed"] = run_as(PLAYER, "neurotouch", "resume")
    wait_for(reader.is_pushed)
    saw["stranger"] = run("runuser", "-u", "nobody", "--", "neurotouch", "pause")
    saw["root"] = run("neurotouch", "reload")
    return saw


def start_another(desk: Desk) -> dict[str, Any]:
    """A second driver, by root and by the user; the first plays on."""
    before = desk.identity()
    saw = {
        "root": run("neurotouch", "run"),
        "player": run_as(PLAYER, "neurotouch", "run"),
        "service": run("neurotouch", "service"),
    }
    desk.play_until_pushed()
    return {**saw, "same": before == desk.identity()}


def pull(desk: Desk) -> dict[str, Any]:
    """The cable pulled in the middle of a gesture, three times."""
    before = desk.identity()
    neutral_after_s = []
    for _ in range(3):
        reader = desk.play_until_pushed()
        pulled_s = desk.camera.pull()
        neutral_after_s.append(reader.neutral_after(pulled_s))
        time.sleep(2.0)
        stays = reader.is_neutral() and reader.ended is None
        status = run("neurotouch", "status")
        desk.camera.plug()
        desk.play_until_pushed()
    return {
        "neutral_after_s": neutral_after_s,
        "stays": stays,
        "same": before == desk.identity(),
        "same_reader_pushed": reader.is_pushed() or bool(wait_for(reader.is_pushed)),
        "status": status,
    }


def storm(desk: Desk) -> dict[str, Any]:
    """Plugged and pulled at random moments, in the end another camera: play goes on."""
    before, n_before = desk.identity(), count_descriptors()
    reader = desk.read_pad()
    chance = random.Random(5)
    for _ in range(N_STORM):
        desk.camera.plug()
        time.sleep(chance.uniform(0.0, 3.0))
        desk.camera.pull()
        time.sleep(chance.uniform(0.0, 1.0))
    desk.camera.plug("00000002")
    plugged_s = time.monotonic()
    wait_for(reader.is_neutral)
    wait_for(reader.is_pushed)
    return {
        "plays_after_s": time.monotonic() - plugged_s,
        "same": before == desk.identity(),
        "descriptors": (n_before, count_descriptors()),
        "restarts": show("NRestarts")["NRestarts"],
    }


def count_descriptors() -> int:
    """How many files the service has open."""
    return len(list(Path(f"/proc/{main_pid()}/fd").iterdir()))


def switch_off(desk: Desk) -> dict[str, Any]:
    """The port switched off and on again by sysfs, as USBGuard and power scripts do."""
    before = desk.identity()
    reader = desk.play_until_pushed()
    port = next(
        vendor.parent
        for vendor in Path("/sys/bus/usb/devices").glob("*/idVendor")
        if vendor.read_text().strip() == "152a"
    )
    (port / "authorized").write_text("0")
    wait_for(reader.is_neutral)
    (port / "authorized").write_text("1")
    wait_for(reader.is_pushed)
    return {"same": before == desk.identity()}


def crash(desk: Desk) -> dict[str, Any]:
    """Killed in the middle of a gesture: nothing stuck, and back without a command."""
    reader = desk.play_until_pushed()
    os.kill(main_pid(), signal.SIGKILL)
    wait_for(lambda: reader.ended)
    desk.play_until_pushed()
    return {"ended": reader.ended, "restarts": show("NRestarts")["NRestarts"]}


def hang(desk: Desk) -> dict[str, Any]:
    """Stopped in its tracks: the watchdog ends it and a new one plays."""
    reader = desk.play_until_pushed()
    os.kill(main_pid(), signal.SIGSTOP)
    begun_s = time.monotonic()
    wait_for(lambda: reader.ended, 120)
    after_s = time.monotonic() - begun_s
    desk.play_until_pushed()
    return {"ended": reader.ended, "after_s": after_s}


def stay_mute(desk: Desk) -> dict[str, Any]:
    """Without a camera for longer than the watchdog's limit: nothing is restarted."""
    before = desk.identity()
    desk.camera.pull()
    time.sleep(40.0)
    saw = {"same": before == desk.identity(), "status": show("StatusText", "ActiveState")}
    desk.camera.plug()
    desk.play_until_pushed()
    return saw


def stop(desk: Desk) -> dict[str, Any]:
    """Stopped in the middle of a gesture, then started by a plug again."""
    reader = desk.play_until_pushed()
    done = run("systemctl", "stop", SERVICE)
    wait_for(lambda: reader.ended)
    saw = {
        "seconds": done["seconds"],
        "left_pressed": [[*control, value] for control, value in reader.pressed().items()],
        "pad": find_pad(),
        "result": show("Result", "ExecMainStatus", "ActiveState"),
    }
    desk.camera.pull()
    time.sleep(1.0)
    desk.camera.plug()
    desk.play_until_pushed()
    return saw


def read_settings(desk: Desk) -> dict[str, Any]:
    """A mistake in service.yaml is named with its line; mended, it plays."""
    file = Path("/etc/neurotouch/service.yaml")
    right = file.read_text()
    file.write_text("version: 1\nprofil: spacecraft\n")
    failed = run("systemctl", "restart", SERVICE)
    journal = run("journalctl", "--unit", SERVICE, "--no-pager", "--lines=12")["out"]
    file.write_text(right.replace("#profile", "profile"))
    mended = run("systemctl", "restart", SERVICE)
    desk.play_until_pushed()
    status = json.loads(run("neurotouch", "status", "--json")["out"])
    file.write_text(right)
    return {"failed": failed, "journal": journal, "mended": mended, "profile": status["profile"]}
