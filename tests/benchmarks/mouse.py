"""From the mouse to the pad: ``python -m tests.benchmarks.mouse [SECONDS]``.

Drags round the gel in a real Chromium. Each move of the mouse carries the browser's stamp; the
driver compares it with the moment the slice in which the gel has followed was written to the pad.
"""

import math
import os
import re
import subprocess
import sys
import tempfile
import time

from playwright.sync_api import sync_playwright

from tests.page.conftest import find_chromium


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 15.0
    with tempfile.TemporaryDirectory() as folder:
        demo = subprocess.Popen(
            [sys.executable, "-m", "neurotouch_hid", "demo", "--mouse"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "RUNTIME_DIRECTORY": folder},
        )
        link = ""
        for line in demo.stderr:
            link = link or "".join(re.findall(r"here: (\S+)", line))
            if "Gamepad ready" in line:
                break
        try:
            print(_drag(link, seconds))
        finally:
            demo.terminate()
            demo.communicate()


def _drag(link: str, seconds: float) -> str:
    with sync_playwright() as playwright:
        options = ["--no-sandbox"] if os.geteuid() == 0 else []
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=options)
        page = browser.new_page()
        page.goto(link)
        page.wait_for_function("() => document.getElementById('say').textContent === 'At rest'")
        box = page.locator("#gel").bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        size = 7 * min(box["width"], box["height"]) / 66
        page.mouse.move(x, y)
        page.mouse.down()
        begun = time.monotonic()
        while (t := time.monotonic() - begun) < seconds:
            page.mouse.move(x + size * math.cos(2 * t), y + size * math.sin(2 * t))
            time.sleep(0.008)
        said = page.inner_text("#lag")
        browser.close()
    return said


main()
