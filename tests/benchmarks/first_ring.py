"""From the icon to the first ring: ``python -m tests.benchmarks.first_ring [N]``.

Starts the page's server as the icon does, opens the page in a browser that already runs, presses
the three buttons, and flies by the arrow keys as the advice says. Prints seconds: median and most.
"""

import shutil
import statistics
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path

from playwright.sync_api import sync_playwright

from tests.processes import View

STAGES = ("page readable", "gel runs", "flying", "first ring", "in all")
KEYS = {"left": "ArrowLeft", "right": "ArrowRight", "up": "ArrowUp", "down": "ArrowDown"}
LOOK_S = 0.03
FIRST_MS = 180_000  # the first start on a machine compiles


def main() -> None:
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    with sync_playwright() as playwright:
        program = shutil.which("chromium")
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        _measure(browser)  # warms what a second start finds
        rows = [_measure(browser) for _ in range(n)]
        browser.close()
    for stage, seconds in zip(STAGES, zip(*rows, strict=True), strict=True):
        median_s = statistics.median(seconds)
        print(f"{stage:>14}  median {median_s:5.2f} s  most {max(seconds):5.2f} s")


def _measure(browser) -> list[float]:
    with tempfile.TemporaryDirectory() as folder:
        context = browser.new_context()
        context.set_default_timeout(FIRST_MS)
        page = context.new_page()
        moments = [time.perf_counter()]
        view = View(Path(folder), "--edit")
        page.goto(view.home)
        page.wait_for_function("() => !document.getElementById('start-mouse').hidden")
        moments.append(time.perf_counter())
        page.click("#start-mouse")
        page.wait_for_selector("#fly:not([hidden])")
        moments.append(time.perf_counter())
        page.click("#fly")
        page.wait_for_selector("#gel-panel:not([hidden])")
        page.click("#fly")
        page.wait_for_function("() => document.body.dataset.mode === 'flying'")
        moments.append(time.perf_counter())
        _fly(page)
        moments.append(time.perf_counter())
        context.close()
        view.end()
    stages = [after - before for before, after in pairwise(moments)]
    return [*stages, moments[-1] - moments[0]]


def _fly(page) -> None:
    held: set[str] = set()
    while page.inner_text("#rings").startswith("0 "):
        advice = page.inner_text("#advice").lower()
        wanted = {key for way, key in KEYS.items() if "push" in advice and way in advice}
        for key in held - wanted:
            page.keyboard.up(key)
        for key in wanted - held:
            page.keyboard.down(key)
        held = wanted
        time.sleep(LOOK_S)


if __name__ == "__main__":
    main()
