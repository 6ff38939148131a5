"""The right of a phone: when it ends."""

import asyncio

from neurotouch_hid.page import requests as page_requests
from neurotouch_hid.page.edits import Changes
from neurotouch_hid.page.own_values import OwnValues
from neurotouch_hid.page.requests import Requests


def test_a_second_phone_has_its_whole_time(tmp_path, monkeypatch):
    """The right of the first one ended by the button; its timer must not end the second one."""
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    monkeypatch.setattr(page_requests, "_find_own_address", lambda: "127.0.0.2")
    told: list[dict] = []

    async def let_in(requests: Requests) -> asyncio.TimerHandle:
        before = len(told)
        await requests.carry_out({"do": "remote"}, tmp_path)
        while not any(each.get("remote") for each in told[before:]):
            await asyncio.sleep(0.05)
        return requests._expiry

    async def end(requests: Requests) -> None:
        while told[-1] != {"remote": None}:
            await asyncio.sleep(0.05)

    async def play() -> None:
        requests = Requests(
            edit=True,
            is_far=False,
            changes=Changes(lambda: "now"),
            own=OwnValues(lambda: "now"),
            tell_all=told.append,
        )
        first = await let_in(requests)
        await requests.carry_out({"do": "stop", "what": "remote"}, tmp_path)
        await end(requests)
        second = await let_in(requests)
        assert first.cancelled()
        assert not second.cancelled()
        assert second.when() - asyncio.get_running_loop().time() > page_requests.REMOTE_S - 600
        second._run()  # its time is over
        await end(requests)
        await requests.close()

    asyncio.run(play())
