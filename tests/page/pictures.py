"""Makes the pictures of the documents: ``python -m tests.page.pictures [FOLDER]``.

The real driver on the simulated gel, the real server, a real Chromium; nothing is drawn by hand.
"""

import io
import os
import re
import sys
import tempfile
import time
from contextlib import suppress
from itertools import pairwise
from pathlib import Path

import numpy as np
from PIL import Image
from playwright.sync_api import Browser, Page, sync_playwright
from playwright.sync_api import TimeoutError as PlaywrightTimeoutError

from tests.page.conftest import PROFILE, find_chromium
from tests.processes import Driver, Process, View

FOLDER = Path(__file__).parents[2] / "docs" / "pictures"
DESK = {"width": 1280, "height": 860}
PHONE = {"width": 390, "height": 844}
TOUR_S = 18.0
FRAME_MS = 180
STILL_S = 9.6


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as home, sync_playwright() as playwright:
        options = ["--no-sandbox"] if os.geteuid() == 0 else []
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=options)
        take_tour(browser, Path(home) / "tour", folder)
        take_view(browser, Path(home) / "view", folder)
        take_gel(browser, Path(home) / "mouse", folder)
        browser.close()
    for path in sorted((*folder.glob("*.png"), *folder.glob("*.gif"))):
        print(f"{path}  {path.stat().st_size // 1000} kB")


def take_tour(browser: Browser, home: Path, folder: Path) -> None:
    """The live view through one round of all gestures, as a moving picture and as a still one."""
    driver = Driver(home, "sim:tour", "spacecraft")
    view = View(home, "--edit")
    try:
        page = browser.new_page(
            viewport={"width": 1120, "height": 1000},
            device_scale_factor=720 / 1120,
            color_scheme="dark",
        )
        page.goto(view.link)
        wait_for_calm(page)
        wait_for(page, "Twist counter")
        wait_for(page, "Push up [5-9]")  # where a page shows no motion, the first frame stays
        gel = page.locator("#disc").bounding_box()
        clip = {"x": 0, "y": 0, "width": 1120, "height": gel["y"] + gel["height"] + 8}
        frames = []
        begin = time.monotonic()
        while (now := time.monotonic() - begin) < TOUR_S:
            shot = page.screenshot(clip=clip)
            frames.append((now, Image.open(io.BytesIO(shot)).convert("RGB")))
            page.wait_for_timeout(max(0.0, FRAME_MS - 1000 * (time.monotonic() - begin - now)))
        page.close()
    finally:
        view.end()
        driver.end()
    write_animation(frames, folder / "tour.gif")
    still = min(frames, key=lambda frame: abs(frame[0] - STILL_S))[1]
    still.save(folder / "tour.png", optimize=True)


def write_animation(frames: list[tuple[float, Image.Image]], path: Path) -> None:
    """Writes frames at their own times, in one palette: colours do not flicker, files are small."""
    sample = np.concatenate([np.asarray(frame).reshape(-1, 3) for _, frame in frames[::4]])
    values, counts = np.unique(sample, axis=0, return_counts=True)
    common = values[np.argsort(counts)[-12:]]  # the page and its cards: exactly
    vivid = values[np.ptp(values, axis=1) > 50]
    colours = [common.ravel().tolist(), choose_colours(vivid, 36), choose_colours(sample, 80)]
    palette = Image.new("P", (1, 1))
    palette.putpalette([value for part in colours for value in part])
    pictures = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for _, frame in frames]
    times = [at for at, _ in frames] + [frames[-1][0] + FRAME_MS / 1000]
    pictures[0].save(
        path,
        save_all=True,
        append_images=pictures[1:],
        duration=[round(100 * (b - a)) * 10 for a, b in pairwise(times)],
        loop=0,
        optimize=True,
    )


def choose_colours(pixels: np.ndarray, number: int) -> list[int]:
    """A palette of at most so many colours, flat as Pillow has it."""
    return Image.fromarray(pixels[None]).quantize(number).getpalette()[: 3 * number]


def take_view(browser: Browser, home: Path, folder: Path) -> None:
    """The live view on a desk and on a phone, and the game in its attract mode."""
    profiles = home / "config" / "neurotouch" / "profiles"
    profiles.mkdir(parents=True)
    (profiles / "mine.yaml").write_text(PROFILE.replace("accept_ms: 5000", "accept_ms: 1500"))
    driver = Driver(home, "sim:tour")
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
        take_home(browser, view, folder)
        take_sheet(browser, view, folder)
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


def take_home(browser: Browser, view: View, folder: Path) -> None:
    """The first page, with a profile that a person has begun with."""
    page = browser.new_page(viewport={"width": 1280, "height": 1000}, color_scheme="light")
    page.goto(view.home)
    page.wait_for_selector("[data-movement=pinch] li:has-text('button A')")
    page.wait_for_selector("#profile-choice option", state="attached")
    found = "() => /simulated/.test(document.getElementById('situation').textContent)"
    page.wait_for_function(found)
    page.screenshot(path=folder / "home.png", full_page=True)
    page.close()


def take_sheet(browser: Browser, view: View, folder: Path) -> None:
    """The sheet as it comes out of the printer."""
    page = browser.new_page(viewport={"width": 760, "height": 400}, color_scheme="light")
    page.goto(view.page("sheet"))
    page.wait_for_selector("#layers td")
    page.wait_for_selector("#stop-keys:not([hidden])")
    page.emulate_media(media="print")
    page.screenshot(path=folder / "sheet.png", full_page=True)
    page.close()


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
