"""Programs that the page starts: one after the other, also while the one before still ends."""

import asyncio

from neurotouch_hid.page import programs


def test_a_driver_that_is_ending_keeps_no_other_from_starting(monkeypatch):
    commands = iter([["sleep", "0.5"], ["true"]])
    monkeypatch.setattr(programs, "make_own_command", lambda *_: next(commands))
    told = []

    async def start_twice():
        made = programs.Programs(told.append)
        await made.start("mouse")
        await made.start("camera")  # one driver at a time
        await made.close()

    asyncio.run(start_twice())
    assert [each["name"] for each in told] == ["mouse", "camera"]  # in the order of their ends
