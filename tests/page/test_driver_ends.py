"""The page's server beside a driver that ends: the newest word is that none runs."""

import json
import os
import signal
import socket

from websockets.sync.client import connect

from neurotouch_hid.driver_state import pack
from neurotouch_hid.ipc import FEED, listen_at
from tests.page.played import REST
from tests.processes import LIMIT_S, View

MARKERS = bytes(9 * 177)


def test_a_last_state_that_comes_with_the_end_is_no_driver(tmp_path):
    """Both wait in the socket together, as on a busy machine."""
    view = View(tmp_path)
    try:
        (tmp_path / "run").mkdir(mode=0o700, exist_ok=True)
        with listen_at(tmp_path / "run" / FEED) as listener, _open_stream(view) as page:
            page.send(json.dumps({"token": view.token, "hz": 60}))
            listener.settimeout(LIMIT_S)
            driver, _ = listener.accept()
            driver.settimeout(LIMIT_S)
            while driver.recv(16) != b"60":  # unread rates would end the line with an error
                pass
            _send(driver)
            assert isinstance(_read_until(page, bytes), bytes)
            os.kill(view.process.pid, signal.SIGSTOP)
            _send(driver)
            driver.close()
            listener.close()
            (tmp_path / "run" / FEED).unlink()
            os.kill(view.process.pid, signal.SIGCONT)
            heard = []
            while not any("situation" in each for each in heard):
                heard.append(json.loads(_read_until(page, str)))
            assert {"driver": False} in heard
    finally:
        os.kill(view.process.pid, signal.SIGCONT)
        view.end()


def _open_stream(view):
    address = f"127.0.0.1:{view.port}"
    return connect(f"ws://{address}/stream", origin=f"http://{address}")


def _send(driver: socket.socket) -> None:
    driver.send(pack(REST, MARKERS))


def _read_until(page, kind: type) -> str | bytes:
    while True:
        message = page.recv(10.0)
        if isinstance(message, kind):
            return message
