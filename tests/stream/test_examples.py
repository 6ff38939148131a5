"""The examples for other programs, in these programs."""

import csv
import functools
import http.server
import os
import shutil
import subprocess
import sys
import threading
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import sync_playwright

from neurotouch_hid.stream import open_target
from neurotouch_hid.stream.target import Address
from tests.page.conftest import find_chromium
from tests.processes import run_command
from tests.stream.test_targets import PINCH

EXAMPLES = Path(__file__).parents[2] / "examples" / "streams"
LIMIT_S = 120.0
HEADLESS = {"godot": ("--headless",)}
"""Options with which a program needs no screen."""


def find_program(name: str, package: str, required_by: str = "") -> str:
    """Another program; its test is skipped where there is none."""
    found = shutil.which(name)
    if found is None:
        sentence = f"no {name} here (Debian: apt install {package})"
        if os.environ.get(required_by) == "1":
            pytest.fail(f"it is required, but there is {sentence}")
        pytest.skip(sentence)
    return found


@contextmanager
def playing(target):
    """Sends a state to a target again and again, from a thread."""
    done = threading.Event()

    def send():
        while not done.wait(0.02):
            target.send(PINCH)

    thread = threading.Thread(target=send)
    thread.start()
    yield
    done.set()
    thread.join()


def test_pure_data_prints_the_strength():
    words = [
        find_program("pd", "puredata-core", "NEUROTOUCH_REQUIRE_PURE_DATA"),
        "-nogui",
        "-noaudio",
        "-nomidi",
        "-stderr",
        str(EXAMPLES / "push.pd"),
    ]
    with (
        subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as pd,
        open_target(Address("osc", "127.0.0.1", 9000), markers=True) as target,
        playing(target),
    ):
        said = set()
        for line in pd.stderr:
            said.add(line.strip())
            if {"strength: 0.325", "gesture: symbol pinch"} <= said or len(said) > 20:
                break
        pd.kill()
    assert "strength: 0.325" in said
    assert "gesture: symbol pinch" in said


MAIN_3 = """\
extends SceneTree

var gel: Spatial
var frames := 0

func _init() -> void:
\tgel = load("res://gel.gd").new()
\troot.add_child(gel)

func _idle(_delta: float) -> bool:
\tframes += 1
\tif gel.translation.x == 0.0 and frames < 100000:
\t\treturn false
\tprint("moved: %.2f %.2f, turned: %.2f, scale: %.3f" % [
\t\tgel.translation.x, gel.translation.z, gel.rotation.y, gel.scale.x])
\tquit()
\treturn false
"""
"""A program of Godot 3 with nothing but the example's node."""
MAIN_4 = """\
extends SceneTree

var gel: Node3D
var frames := 0

func _initialize() -> void:
\tgel = load("res://gel.gd").new()
\troot.add_child(gel)

func _process(_delta: float) -> bool:
\tframes += 1
\tif gel.position.x == 0.0 and frames < 10000:
\t\treturn false
\tprint("moved: %.2f %.2f, turned: %.2f, scale: %.3f" % [
\t\tgel.position.x, gel.position.z, gel.rotation.y, gel.scale.x])
\treturn true
"""
"""The same of Godot 4."""


@pytest.mark.parametrize(
    ("program", "package", "example", "main"),
    [
        ("godot3-server", "godot3-server", "gel_godot3.gd", MAIN_3),
        ("godot", "godot, from testing on", "gel.gd", MAIN_4),
    ],
)
def test_godot_moves_a_node(tmp_path, program, package, example, main):
    godot = find_program(program, package)
    script = (EXAMPLES / example).read_text()
    with open_target(Address("websocket", "127.0.0.1", 0), markers=False) as target:
        (tmp_path / "gel.gd").write_text(script.replace("ws://127.0.0.1:8765", target.name))
        (tmp_path / "main.gd").write_text(main)
        (tmp_path / "project.godot").touch()
        with playing(target):
            said = run_command(
                godot,
                "--path",
                tmp_path,
                "-s",
                "main.gd",
                *HEADLESS.get(program, ()),
                env={**os.environ, "HOME": str(tmp_path), "XDG_DATA_HOME": str(tmp_path)},
            ).stdout
    assert "moved: 0.05 -0.15, turned: -0.25, scale: 0.875" in said


def test_lsl_is_recorded(tmp_path):
    file = tmp_path / "touch.csv"
    with open_target(Address("lsl"), markers=False) as target, playing(target):
        words = [sys.executable, str(EXAMPLES / "record_lsl.py"), str(file), "1"]
        subprocess.run(words, check=True, timeout=LIMIT_S)
    with file.open() as lines:
        rows = list(csv.DictReader(lines))
    assert len(rows) > 3
    assert {row["intensity"] for row in rows} == {"3.25"}
    assert {row["contact_2_x"] for row in rows} == {"10.0"}


def test_a_browser_shows_the_gesture(tmp_path):
    page = (EXAMPLES / "gesture.html").read_text()
    with open_target(Address("websocket", "127.0.0.1", 0), markers=False) as target:
        (tmp_path / "gesture.html").write_text(page.replace("ws://127.0.0.1:8765", target.name))
        handler = functools.partial(_Quiet, directory=tmp_path)
        with http.server.HTTPServer(("127.0.0.1", 0), handler) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            with playing(target), sync_playwright() as playwright:
                browser = playwright.chromium.launch(
                    executable_path=find_chromium(), args=["--no-sandbox"]
                )
                shown = browser.new_page()
                shown.goto(f"http://127.0.0.1:{server.server_port}/gesture.html")
                shown.wait_for_selector(".contact >> nth=1", state="attached")
                assert shown.inner_text("#kind") == "pinch 3.3 mm"
                browser.close()
            server.shutdown()


class _Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        """Says nothing."""
