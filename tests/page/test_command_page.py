"""The page of a command, as a browser talks with it."""

import json
from contextlib import ExitStack
from types import SimpleNamespace

import pytest

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.page.command_page import CommandPage
from tests.page.connecting import enter, read_to_the_end, show_token
from tests.processes import LIMIT_S


def open_line(page):
    return enter(SimpleNamespace(port=int(page.url.rsplit(":", 1)[1].strip("/"))))


def read(line):
    return json.loads(line.recv(LIMIT_S))


def send(line, **message):
    line.send(json.dumps(message))


def test_browser_that_comes_later_shows_the_same():
    with CommandPage([("a", "Go on")], title="Try", request="one") as page:
        with open_line(page) as line:
            assert show_token(line, page.token)["shown"]["request"] == "one"
            page.show(request="one")  # nothing new: nothing is sent
            page.show(request="two", heard=[[1, "x"]])
            message = read(line)
        assert message["shown"] == {
            "keys": [["a", "Go on"]],
            "title": "Try",
            "request": "two",
            "heard": [[1, "x"]],
        }
        with open_line(page) as line:
            assert show_token(line, page.token) == message


def test_only_its_keys_are_taken():
    with CommandPage([("a", "Go on")], title="Try") as page, open_line(page) as line:
        show_token(line, page.token)
        assert page.poll() is None
        for pressed in ({"press": "q"}, {"press": ["a"]}, {"seen": "x"}, {}):
            send(line, **pressed)
            assert "unknown" in read(line)["refused"]
        line.send("[" * 50)
        assert "unknown" in read(line)["refused"]
        send(line, press="a")
        send(line)
        read(line)
        assert page.poll() == "a"
        assert page.poll() is None


def test_stranger_sees_nothing():
    with CommandPage([], title="Try") as page, open_line(page) as line:
        send(line, token="wrong", hz=0)
        assert read_to_the_end(line) == 1008


def test_failure_is_shown_at_the_end():
    with ExitStack() as stack:
        page = CommandPage([], title="Try")
        with pytest.raises(NeuroTouchError), page:  # noqa: PT012
            line = stack.enter_context(open_line(page))
            show_token(line, page.token)
            raise NeuroTouchError("The camera is gone.")
        last = read(line)["shown"]
    assert last["ended"]
    assert last["problem"] == "The camera is gone."
