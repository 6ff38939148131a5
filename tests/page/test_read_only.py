"""A page changes nothing unless it was asked for, and never a file or a real driver."""

import json

import pytest

from tests.page.connecting import enter, show_token
from tests.processes import LIMIT_S


@pytest.mark.parametrize(
    "wish",
    [
        {"do": "set", "key": "pinch", "mark": "on_mm", "value": 3},
        {"do": "undo"},
        {"do": "pause"},
        {"do": "resume"},
        {"do": "write", "pad": {"buttons": ["a"]}},
        {"do": "press", "button": "a"},
        {},
        [],
    ],
)
def test_a_page_without_edit_can_do_nothing(server, wish):
    with enter(server) as line:
        show_token(line, server.token)
        line.send(json.dumps(wish))
        while "refused" not in (said := json.loads(line.recv(LIMIT_S))):
            pass
        assert said["refused"]


def test_an_editing_page_names_no_file(view, driver, folder):
    before = {path: path.read_bytes() for path in folder.rglob("*.yaml")}
    refused = 0
    with enter(view) as line:
        show_token(line, view.token, hz=5)
        wait_for_about(line)
        for wish in (
            {"key": "../../user.slots", "mark": "on_mm", "value": 3},
            {"key": "pinch", "mark": "extends", "value": 3},
            {"key": "name", "mark": "on_mm", "value": 3},
            {"key": "pinch", "mark": "on_mm", "value": "3; rm"},
            {"key": "pinch", "mark": "on_mm", "value": 1e999},
            {"key": "pinch", "mark": "on_mm", "value": 99},
            {"key": "push", "mark": "points", "value": [["a", "b"]]},
            {"key": "pinch", "file": "/etc/passwd", "mark": "off_mm", "value": 9},
        ):
            line.send(json.dumps({"do": "set", **wish}))
            while True:
                if not isinstance(said := line.recv(LIMIT_S), str):
                    continue
                said = json.loads(said)
                assert "saved" not in said, wish
                if "refused" in said:
                    refused += 1
                    break
    assert refused == 8
    assert {path: path.read_bytes() for path in folder.rglob("*.yaml")} == before


def wait_for_about(line):
    while not isinstance((said := line.recv(LIMIT_S)), str) or not json.loads(said).get("about"):
        pass


def test_what_a_page_says_moves_no_real_driver(view, driver):
    """A driver that plays something else than the mouse's gel has nobody to hear a hand."""
    assert not (driver.folder / "run" / "hand").exists()
    with enter(view) as line:
        show_token(line, view.token)
        line.send(json.dumps({"do": "hand", "down": True, "push_x_mm": 9}))
        line.send(json.dumps({"do": "nonsense"}))
        while "refused" not in json.loads(line.recv(LIMIT_S)):
            pass
    assert driver.process.poll() is None
