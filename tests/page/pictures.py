"""Makes the pictures of the README: ``python -m tests.page.pictures [FOLDER]``.

The real driver on the simulated gel, the real server, a real Chromium; nothing is drawn by hand.
"""

import os
import re
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright
from playwright.sync_api import TimeoutError as PlaywrightTimeoutError

from tests.page.conftest import PROFILE, find_chromium
from tests.page.processes import Driver, Process, View

FOLDER = Path(__file__).parents[2] / "docs" / "pictures"
DESK = {"width": 1280, "height": 860}
PHONE = {"width": 390, "height": 844}


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as home, sync_playwright() as playwright:
        options = ["--no-sandbox"] if os.geteuid() == 0 else []
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=options)
        take_view(browser, Path(home), folder)
        take_gel(browser, Path(home) / "mouse", folder)
        browser.close()
    for path in sorted(folder.glob("*.png")):
        print(f"{path}  {path.stat().st_size // 1000} kB")


def take_view(browser: Browser, home: Path, folder: Path) -> None:
    """The live view on a desk and on a phone, and the game in its attract mode."""
    profiles = home / "config" / "neurotouch" / "profiles"
    profiles.mkdir(parents=True)
    (profiles / "mine.yaml").write_text(PROFILE.replace("accept_ms: 5000", "accept_ms: 1500"))
    driver = Driver(home)
    view = View(home, "--edit")
    try:
        for name, size, scheme in (("view", DESK, "dark"), ("view-phone", PHONE, "light")):
            page = browser.new_page(viewport=size, color_scheme=scheme)
            page.goto(view.link)
            page.wait_for_selector("#actions .ignored")
            wait_for_calm(page)
            wait_for(page, r"Push right [67]")
            page.screenshot(path=folder / f"{name}.png", full_page=name == "view")
            page.close()
        page = browser.new_page(viewport=DESK)
        page.clock.install()
        page.goto(view.page("game"))
        page.click("#watch")
        page.clock.run_for(7_400)
        page.screenshot(path=folder / "game.png")
        page.close()
    finally:
        view.end()
        driver.end()


def take_gel(browser: Browser, home: Path, folder: Path) -> None:
    """The gel under a mouse that drags."""
    demo = Process(home, "demo", "--mouse", ready="Gamepad ready")
    try:
        link = re.search(r"Press the gel here: (\S+)", demo.said)[1]
        page = browser.new_page(viewport=DESK, color_scheme="dark")
        page.goto(link)
        wait_for(page, "At rest")
        box = page.locator("#gel").bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.mouse.move(x - 30, y + 40)
        page.mouse.down()
        page.mouse.move(x + 40, y - 10, steps=30)
        wait_for(page, r"Push up-right [5-9]")
        page.wait_for_function("() => document.getElementById('lag').textContent")
        page.screenshot(path=folder / "gel.png")
        page.close()
    finally:
        demo.end()


def wait_for_calm(page: Page) -> None:
    """Waits a while until a driver that began late has caught up, on a busy machine."""
    with suppress(PlaywrightTimeoutError):
        page.wait_for_function(
            "() => /backlog[0-9.]{1,4} ms/.test(document.getElementById('health').textContent)",
            timeout=60_000,
        )


def wait_for(page: Page, words: str) -> None:
    """Waits until the sentence begins so."""
    page.wait_for_function(
        "words => new RegExp('^' + words).test(document.getElementById('say').textContent)",
        arg=words,
        timeout=90_000,
    )


if __name__ == "__main__":
    main()
