"""The page beside the service: what the person at the seat changes acts on what plays."""

import os
import sys

import pytest

from tests.cli.test_session import PLAY
from tests.page.conftest import PROFILE
from tests.page.waiting import wait_for, wait_on
from tests.processes import Process, View
from tests.repeated import find_tour, offer_repeated

ON = "[data-movement=pinch] .mark-on_mm"


class Service(Process):
    """A driver with settings of its own, which keeps those of the person at the seat."""

    def __init__(self, folder) -> None:
        seated = folder / "seated"
        seated.write_text(f"{os.getuid()}\n")
        places = [str(seated), str(folder / "state/people")]
        (folder / "state").mkdir()
        super().__init__(
            folder,
            program=[sys.executable, "-c", PLAY, f"repeated:{find_tour()}", *places],
            ready="",
            XDG_CONFIG_HOME=str(folder / "machine"),
            **offer_repeated(folder / "packages"),
        )
        self.wait((folder / "run/control").exists)

    def read_copy(self) -> str:
        """The service's copy of the person's profile."""
        path = self.folder / f"state/people/{os.getuid()}/profiles/mine.yaml"
        return path.read_text() if path.exists() else ""


@pytest.fixture
def place(tmp_path):
    """A service that plays the tour, and the page of a person with a profile."""
    own = tmp_path / "config/neurotouch"
    (own / "profiles").mkdir(parents=True)
    (own / "profiles/mine.yaml").write_text(PROFILE.replace("accept_ms: 5000", "accept_ms: 50"))
    service = Service(tmp_path)
    view = View(tmp_path, "--edit")
    yield service, view
    view.end()
    service.end()


def test_what_is_chosen_bound_and_dragged_acts_on_the_service(place, open_page):
    service, view = place
    page = open_page(view.home)
    wait_for(page, "driver-state", "Running")
    wait_for(page, "badges", "profile default")  # the machine's
    page.select_option("#profile-choice", "mine")
    page.click("#profile-use")
    wait_for(page, "badges", "profile mine")
    page.wait_for_selector("[data-movement=pinch] li:has-text('from 4 mm')")
    page.locator("[data-movement=pinch] li button").first.click()
    page.click("#outputs button:text-is('Y')")
    wait_for(page, "saved", "It applies now.")
    assert 'button: "y"' in service.read_copy()
    page.get_by_label("Tremor filter").select_option("light")
    wait_for(page, "own-said", "It applies now")
    page.goto(view.page("live"))
    wait_for(page, "pressed", "Y")  # a pinch of the tour
    page.wait_for_selector(f"{ON}.draggable")
    mark, lane = page.locator(ON), page.locator("[data-movement=pinch] .marks").bounding_box()
    mark.scroll_into_view_if_needed()
    box = mark.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + lane["width"] * 2.0 / 15, y, steps=5)
    page.mouse.up()
    wait_for(page, "saved", "It applies now.")
    assert "acts from 6 mm" in page.inner_text("#saved")  # the threshold was kept
    assert "on_mm: 6" in service.read_copy()
    page.click("#undo")
    wait_for(page, "saved", "as before that change. It applies now.")
    assert "on_mm: 6" not in service.read_copy()


def test_a_profile_that_was_looked_at_can_be_changed_once_it_plays(place, open_page):
    """Also where the news of the profile comes before the state that names it."""
    _, view = place
    page = open_page(view.home)
    is_late, abouts = [False], []

    def pass_on(line) -> None:
        def hear(message: str | bytes) -> None:
            if isinstance(message, str):
                abouts.append('"about"' in message)
            elif is_late[0]:
                return
            line.send(message)

        line.connect_to_server().on_message(hear)

    page.route_web_socket("**", pass_on)
    page.reload()
    wait_for(page, "badges", "profile default")
    page.select_option("#profile-choice", "mine")
    page.wait_for_selector("[data-movement=pinch] li:has-text('from 4 mm')")
    is_late[0], n = True, sum(abouts)
    page.click("#profile-use")
    wait_on(page, lambda: sum(abouts) > n)
    page.wait_for_timeout(2000)  # no more of it follows
    is_late[0] = False
    wait_for(page, "badges", "profile mine")
    page.locator("[data-movement=pinch] li button").first.wait_for()
