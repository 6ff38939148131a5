"""A real browser, a driver to look at, and the server between them.

They cost a good part of a core as long as they run, so each module has its own, ends them when it
ends, and stays in one process.
"""

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from tests.page import chromium
from tests.page.played import PlayedDriver
from tests.page.waiting import wait_for
from tests.processes import Driver, View

PROFILE = """\
# How I play.
version: 1
name: mine
bindings:
  - when: push
    do: {stick: left, range_mm: [1.0, 8.0], curve: {expo: 0.3}}  # steering
  # Jump: not too light.
  - when: {gesture: pinch, on_mm: 4.0, off_mm: 2.0, accept_ms: 5000}  # squeeze
    do: {button: a}
  - when: zoom
    do: {trigger: right}
  - when: twist_cw
    do: {axis: right_x}
"""


def find_chromium() -> str:
    """The browser's program; the tests are skipped where there is none."""
    found = chromium.find_program()
    if found is None:
        if os.environ.get("NEUROTOUCH_REQUIRE_BROWSER") == "1":
            pytest.fail(f"browser tests are required, but there is {chromium.MISSING}")
        pytest.skip(f"browser tests: {chromium.MISSING}")
    return found


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    """Adds to a failure what the open pages say; on another machine nobody sees them."""
    report = yield
    browser = getattr(item, "funcargs", {}).get("browser")
    if report.failed and report.when == "call" and browser is not None:
        for context in browser.contexts:
            for page in context.pages:
                with suppress(Exception):  # whatever it is, the failure is what counts
                    report.sections.append((page.url, page.inner_text("body", timeout=5000)))
    return report


@pytest.fixture(scope="module")
def browser() -> Iterator[object]:
    program = find_chromium()
    from playwright.sync_api import sync_playwright

    options = ["--no-sandbox"] if os.geteuid() == 0 else []
    with sync_playwright() as playwright:
        launched = playwright.chromium.launch(executable_path=program, args=options)
        yield launched
        launched.close()


@pytest.fixture
def open_page(browser):
    """Opens pages in a context of their own; no script of theirs may fail."""
    failures: list[str] = []
    contexts = []

    def open_one(link: str, *, clock: bool = False, **options):
        context = browser.new_context(**{"viewport": {"width": 1280, "height": 1000}, **options})
        contexts.append(context)
        context.set_default_timeout(180_000)
        page = context.new_page()
        if clock:  # the page's time then goes on only when it is told to
            page.clock.install(time=0)
            page.clock.pause_at(1_000)
        page.on("pageerror", lambda error: failures.append(str(error)))
        page.on(
            "console",
            lambda message: failures.append(message.text) if message.type == "error" else None,
        )
        page.goto(link)
        return page

    yield open_one
    for context in contexts:
        context.close()
    assert failures == []


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A person's folders, with a profile."""
    made = tmp_path_factory.mktemp("page")
    profiles = made / "config" / "neurotouch" / "profiles"
    profiles.mkdir(parents=True)
    (profiles / "mine.yaml").write_text(PROFILE)
    return made


@pytest.fixture(scope="module")
def driver(folder: Path) -> Iterator[Driver]:
    """A driver that plays the tour of all gestures, again and again."""
    running = Driver(folder)
    yield running
    running.end()


@pytest.fixture(scope="module")
def view(driver: Driver) -> Iterator[View]:
    """The page's server, which may edit."""
    running = View(driver.folder, "--edit")
    yield running
    running.end()


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """The page's server, which may edit, with no driver."""
    running = View(tmp_path_factory.mktemp("alone"), "--edit")
    yield running
    running.end()


@pytest.fixture
def bare(tmp_path: Path) -> Iterator[View]:
    """The page's server on a machine where nothing runs; each test has its own."""
    (tmp_path / "config/neurotouch/profiles").mkdir(parents=True)
    running = View(tmp_path, "--edit")
    yield running
    running.end()


@pytest.fixture
def play(open_page, alone):
    """Opens a page whose driver the test plays."""

    def open_one(name: str = "live", **options):
        page = open_page("about:blank", **options)
        driver = PlayedDriver(page)
        page.goto(alone.page(name))
        page.wait_for_function("() => document.getElementById('driver-state')")
        driver.show()
        wait_for(page, "driver-state", "Running")
        return page, driver

    return open_one


@pytest.fixture(scope="module")
def server(tmp_path_factory) -> Iterator[View]:
    """A server of the page that may change nothing; no driver runs."""
    running = View(tmp_path_factory.mktemp("server"))
    yield running
    running.end()
