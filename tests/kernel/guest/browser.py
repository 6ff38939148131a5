"""Chromium in the guest: what its Gamepad API says of our pad, and what it shows of a gesture."""

import os
import threading
import time
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from neurotouch_hid.device import Device, open_device
from neurotouch_hid.messages import Button, GamepadState
from neurotouch_hid.page.server import STATIC
from neurotouch_hid.profile import Mapping, load_profile, rehearse
from tests.kernel.guest.opening import run
from tests.page.chromium import find_program

PATIENCE_MS = 400_000.0
"""The browser takes two and a half minutes to start where no hardware helps."""

GESTURE = "rest 200ms; push left 12mm 200ms hold 500ms; rest 200ms"
READ = """() => {
    const pad = [...navigator.getGamepads()].find(Boolean);
    return pad && {id: pad.id, mapping: pad.mapping, axes: [...pad.axes],
        buttons: pad.buttons.map(button => button.value)};
}"""
FLY = "async () => { const p = await import('/game/pilot.js'); return p.steer(p.readGamepad()); }"


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Says nothing."""


def read_gamepad(results: Path) -> dict[str, Any] | None:
    """Start the browser, show it the pad, play a gesture; None where there is no browser."""
    program = find_program()
    if program is None:
        return None
    from playwright.sync_api import sync_playwright

    # Pages see gamepads only where the connection is safe; this machine's own address counts.
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Quiet, directory=str(STATIC)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with open_device("uinput") as pad, sync_playwright() as playwright:
        run("udevadm", "settle", "--timeout=60")
        chromium = playwright.chromium.launch(
            executable_path=program,
            args=["--no-sandbox", "--disable-gpu"],
            timeout=PATIENCE_MS,
            env={**os.environ, "HOME": "/tmp"},
        )
        page = chromium.new_page()
        page.set_default_timeout(PATIENCE_MS)
        page.goto(f"http://127.0.0.1:{server.server_port}/shared/style.css")  # any document will do
        shown = _press_until_seen(pad, page)
        moved = _play(pad, page)
        chromium.close()
    server.shutdown()
    return {"pressed": shown, **moved}


def _press_until_seen(pad: Device, page: Any) -> Any:
    """What the browser shows of a pressed A; it hides a pad until the first press."""
    deadline = time.monotonic() + PATIENCE_MS / 1000
    while time.monotonic() < deadline:
        for buttons in (frozenset({Button.A}), frozenset()):
            pad.write(GamepadState(0, buttons))
            time.sleep(1.0)
            shown = page.evaluate(READ)
            if shown is not None and shown["buttons"][0]:
                return shown
    return None


def _play(pad: Device, page: Any) -> dict[str, Any]:
    """What it shows while a push to the left is held, and afterwards."""
    mapping, pushed, ship = Mapping(load_profile("spacecraft")), None, None
    for gesture in rehearse(GESTURE):
        state = mapping.update(gesture)
        pad.write(state)
        if pushed is None and state.axes.get("left_x", 0.0) < -0.9:
            pushed = _wait_for(page, "-0.9 > pad.axes[0]")
            ship = page.evaluate(FLY)
    return {"pushed": pushed, "ship": ship, "let_go": _wait_for(page, "pad.axes[0] === 0")}


def _wait_for(page: Any, condition: str) -> Any:
    page.wait_for_function(f"() => {{ const pad = ({READ})(); return pad && {condition}; }}")
    return page.evaluate(READ)
