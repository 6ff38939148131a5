"""Ctrl-C ends ``make room`` with a sentence."""

import sys
from contextlib import contextmanager

from tests.room import __main__ as room


def test_ctrl_c_says_that_the_same_command_continues(monkeypatch, capsys, tmp_path):
    @contextmanager
    def interrupt(*_):
        raise KeyboardInterrupt
        yield

    monkeypatch.setattr(room, "handle_interrupts", lambda: None)
    monkeypatch.setattr(room, "open_pool", interrupt)
    monkeypatch.setattr(sys, "argv", ["room", "--folder", str(tmp_path)])
    assert room.main() == 130
    assert capsys.readouterr().err == "Stopped. The same command continues.\n"
