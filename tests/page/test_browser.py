"""The page in a real browser, with a real line behind it."""

import math
import os
import re
import shutil
import signal
import time
from contextlib import suppress

import pytest

from neurotouch_hid.partial_file import write_whole
from tests.page.conftest import PROFILE
from tests.page.waiting import rest_hand, wait_for, wait_on
from tests.processes import LIMIT_S, Driver, Process, View


def wait_for_say(page, words: str) -> str:
    """What it said then: a moment later it may say something else."""
    said = page.wait_for_function(
        "words => { const said = document.getElementById('say').textContent;"
        " return said.startsWith(words) && said; }",
        arg=words,
    )
    return said.json_value()


def wait_for_text(page, path, text: str) -> None:
    with suppress(AssertionError):
        wait_on(page, lambda: path.read_text() == text)
    assert path.read_text() == text


def save(path, text: str) -> None:
    """Replaces a profile as an editor does, so that nobody reads half of it."""
    write_whole(path, text.encode())


def find_box(locator) -> dict[str, float]:
    """Returns where an element is; it may just be drawn anew, and then is nowhere for a moment."""
    found: list[dict[str, float]] = []

    def is_drawn() -> bool:
        found[:] = [box] if (box := locator.bounding_box()) else []
        return bool(found)

    wait_on(locator.page, is_drawn)
    return found[0]


def take_hold(page, mark: str) -> tuple[float, float]:
    """Presses the mouse on a mark, and says where. What is above it may come and go, and move it
    away from a pointer that is on its way; so try again, as a person does."""
    handle = page.locator(mark)
    held: list[tuple[float, float]] = []

    def is_held() -> bool:
        handle.evaluate("handle => handle.scrollIntoView()")  # at once: it may soon be replaced
        box = find_box(handle)
        place = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.mouse.move(*place)
        page.mouse.down()
        if handle.evaluate("handle => handle.classList.contains('held')"):
            held.append(place)
        else:
            page.mouse.move(0, 0)  # whatever it is on, it is not clicked
            page.mouse.up()
        return bool(held)

    wait_on(page, is_held)
    return held[0]


def wait_while_it_runs(page, condition: str) -> None:
    """Waits for a condition in a page whose clock goes only when it is told to."""

    def happened() -> bool:
        page.clock.run_for(100)
        return bool(page.evaluate(condition))

    wait_on(page, happened)


def test_the_sentence_and_the_bars_follow_the_hand(open_page, view):
    page = open_page(view.link)
    assert page.evaluate("location.hash") == ""  # the token has left the address bar
    said = wait_for_say(page, "Push right")
    assert re.fullmatch(r"Push right [\d.]+ mm, \d fingers?( → .*)?", said)
    page.wait_for_function(
        "() => /left stick right \\d+ %/.test(document.getElementById('say').textContent)"
    )
    bar = "[data-movement=push_right] .value"
    page.wait_for_function("bar => Number(document.querySelector(bar).textContent) > 2", arg=bar)
    wait_for_say(page, "Zoom")
    page.wait_for_function(
        "bar => Number(document.querySelector('[data-movement=zoom] .value').textContent) > 1.5"
        " && Number(document.querySelector(bar).textContent) === 0",
        arg=bar,
    )
    live = page.locator("#live")
    assert live.get_attribute("aria-live") == "polite"
    page.wait_for_function("() => document.getElementById('live').textContent.length > 6")


def test_every_part_is_there_in_its_order(open_page, view):
    page = open_page(view.link)
    wait_for_say(page, "Push")
    titles = [each.inner_text() for each in page.locator("main h2").all()]
    assert titles == [
        *("Gestures", "Gel", "Response", "Virtual pad", "Latency", "Health", "Last actions"),
    ]
    page.wait_for_function("() => document.getElementById('stages').rows.length >= 6")
    table = page.inner_text("#stages")
    for stage in ("time slice", "tracker", "gesture", "profile", "kernel", "tremor filter"):
        assert stage in table
    health = page.inner_text("#health")
    assert re.search(r"markers tracked\s+17\d of 177", health)
    assert "repeated:tour" in health
    assert "SIMULATED" in page.inner_text("#badges")


def test_an_ignored_gesture_says_which_rule_did_it(open_page, view):
    page = open_page(view.link)
    page.wait_for_selector("#actions .ignored")
    said = page.inner_text("#actions .ignored >> nth=0")
    assert "pinch" in said
    assert re.search(r"because lasted \d+ ms < 5000 ms", said)


def test_dragging_a_threshold_changes_one_line_of_the_file(open_page, view, folder):
    path = folder / "config/neurotouch/profiles/mine.yaml"
    save(path, PROFILE)
    page = open_page(view.link)
    page.wait_for_selector("[data-movement=pinch] .mark-on_mm.draggable")
    x, y = take_hold(page, "[data-movement=pinch] .mark-on_mm")
    lane = find_box(page.locator("[data-movement=pinch] .marks"))
    page.mouse.move(x + lane["width"] * (6.0 - 4.0) / 15, y, steps=5)
    assert path.read_text() == PROFILE  # nothing is saved while it is held
    page.mouse.up()
    page.wait_for_function(
        "() => document.getElementById('saved').textContent.includes('acts from')"
    )
    before, after = PROFILE.splitlines(), path.read_text().splitlines()
    changed = [(a, b) for a, b in zip(before, after, strict=True) if a != b]
    assert len(changed) == 1
    assert changed[0][1] == changed[0][0].replace("on_mm: 4.0", "on_mm: 6.0")
    page.wait_for_function(
        "() => document.querySelector('[data-movement=pinch] .mark-on_mm')"
        ".getAttribute('aria-valuenow') === '6'"
    )
    page.click("#undo")
    page.wait_for_function(
        "() => document.getElementById('saved').textContent.includes('as before that change')"
    )
    assert path.read_text() == PROFILE


def test_a_range_moves_by_keyboard_and_a_curve_by_hand(open_page, view, folder):
    path = folder / "config/neurotouch/profiles/mine.yaml"
    save(path, PROFILE)
    page = open_page(view.link)
    page.wait_for_selector("[data-movement=push_left] .mark-full.draggable")
    page.locator("[data-movement=push_left] .mark-full").focus()
    for _ in range(5):
        page.keyboard.press("ArrowLeft")
    # Keys that come slowly are saved in between; in the end each of them has counted.
    wait_for_text(page, path, PROFILE.replace("[1.0, 8.0]", "[1.0, 7.5]"))
    page.wait_for_function(
        "() => document.querySelector('[data-movement=push_left] .mark-full').title.includes('7.5')"
    )
    page.select_option("#curve-choice", label="push → stick left")
    x, y = take_hold(page, "#curve-handles .mark-expo")
    plot = find_box(page.locator("#curve-handles"))
    bent = 0.65 - (0.5 + 0.375 * 0.3)  # from expo 0.3 to 0.4, as shares of the height
    page.mouse.move(x, y + bent * plot["height"], steps=4)
    page.mouse.up()
    page.wait_for_function(
        "() => document.getElementById('saved').textContent.includes('bend of 0.4')"
    )
    assert path.read_text() == PROFILE.replace("[1.0, 8.0]", "[1.0, 7.5]").replace(
        "expo: 0.3", "expo: 0.4"
    )
    save(path, PROFILE)


def test_the_curve_follows_the_hand_but_not_while_one_of_its_marks_is_in_use(open_page, view):
    page = open_page(view.link)
    shown = "Number(document.getElementById('curve-choice').value)"
    bar = "document.querySelector('[data-movement={}] .value').textContent"
    zooms = "Number(" + bar.format("zoom") + ") > 1.5"
    pushes = "Number(" + bar.format("push_right") + ") > 2"
    page.wait_for_function(f"() => {pushes} && {shown} === 0")
    page.wait_for_function(f"() => {zooms} && {shown} === 1")
    page.evaluate("window.held = document.querySelector('#curve-handles .mark-full'); held.focus()")
    kept = page.evaluate(shown)
    page.wait_for_function(f"() => {pushes}")
    assert page.evaluate(f"{shown} === {kept} && document.activeElement === window.held")
    page.evaluate("document.activeElement.blur()")
    page.wait_for_function(f"() => {pushes} && {shown} === 0")


def test_no_key_is_lost_when_the_profile_changes_meanwhile(open_page, view, folder):
    path = folder / "config/neurotouch/profiles/mine.yaml"
    save(path, PROFILE)
    page = open_page(view.link, clock=True)  # keys are saved only when the clock goes on
    heard: list[str] = []
    page.on(
        "websocket", lambda line: line.on("framereceived", lambda said: heard.append(str(said)))
    )
    page.reload()
    wait_while_it_runs(page, "() => document.querySelector('.mark-full.draggable')")
    mark = page.locator("[data-movement=push_left] .mark-full")
    mark.focus()
    for _ in range(3):
        page.keyboard.press("ArrowLeft")
    heard.clear()
    elsewhere = PROFILE.replace("on_mm: 4.0", "on_mm: 5.0")
    save(path, elsewhere)
    wait_on(page, lambda: any('"about"' in said for said in heard))
    for _ in range(2):
        page.keyboard.press("ArrowLeft")
    assert path.read_text() == elsewhere
    page.clock.run_for(1_000)
    wait_for_text(page, path, elsewhere.replace("[1.0, 8.0]", "[1.0, 7.5]"))
    wait_while_it_runs(
        page,
        "() => document.querySelector('[data-movement=pinch] .mark-on_mm')"
        ".getAttribute('aria-valuenow') === '5'"
        " && document.activeElement.closest('[data-movement=push_left]')"
        "?.querySelector('.mark-full')?.getAttribute('aria-valuenow') === '7.5'",
    )
    # And back to where it began: nothing to save, but what came meanwhile is shown.
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowLeft")
    heard.clear()
    save(path, path.read_text().replace("on_mm: 5.0", "on_mm: 6.0"))
    wait_on(page, lambda: any('"about"' in said for said in heard))
    page.clock.run_for(1_000)
    wait_while_it_runs(
        page,
        "() => document.querySelector('[data-movement=pinch] .mark-on_mm')"
        ".getAttribute('aria-valuenow') === '6'",
    )
    save(path, PROFILE)


class Relay:
    """Between a page and its server: each side hears only what it is let have."""

    def __init__(self, page) -> None:
        self.saves: list[str] = []
        self.abouts: list[str] = []
        self.holds_abouts = False
        page.route_web_socket("**/stream", self._connect)

    def _connect(self, page_line) -> None:
        self.page_line, self.line = page_line, page_line.connect_to_server()
        page_line.on_message(self._to_server)
        self.line.on_message(self._to_page)

    def _to_server(self, said) -> None:
        if '"do":"set"' in said:
            self.saves.append(said)
        else:
            self.line.send(said)

    def _to_page(self, said) -> None:
        if self.holds_abouts and isinstance(said, str) and '"about"' in said:
            self.abouts.append(said)
        else:
            self.page_line.send(said)

    def let_save(self, instead: tuple[str, str] = ("", "")) -> None:
        self.line.send(self.saves.pop(0).replace(*instead))

    def let_abouts(self) -> None:
        self.holds_abouts = False
        while self.abouts:
            self.page_line.send(self.abouts.pop(0))


FULL = "[data-movement=push_left] .mark-full"
FULL_SAYS = f"document.querySelector('{FULL}')?.getAttribute('aria-valuenow')"
ON = "[data-movement=pinch] .mark-on_mm"
ON_SAYS = f"document.querySelector('{ON}')?.getAttribute('aria-valuenow')"
IS_SAVED = "document.getElementById('saved').textContent.includes('ends at')"


@pytest.fixture
def relayed(open_page, view, folder):
    """A page in edit, whose clock goes only when told to, its relay, and its profile's file."""
    path = folder / "config/neurotouch/profiles/mine.yaml"
    save(path, PROFILE)
    page = open_page(view.link, clock=True)
    relay = Relay(page)
    page.reload()
    wait_while_it_runs(page, f"document.querySelector('{FULL}.draggable')")
    wait_while_it_runs(page, f"{FULL_SAYS} === '8' && {ON_SAYS} === '4'")
    yield page, relay, path
    save(path, PROFILE)


def press(page, n_times: int) -> None:
    page.locator(FULL).focus()
    for _ in range(n_times):
        page.keyboard.press("ArrowLeft")


def test_a_mark_stays_where_it_was_put_until_its_save_is_answered(relayed):
    page, relay, path = relayed
    press(page, 5)
    page.clock.run_for(1_000)
    wait_on(page, lambda: relay.saves)
    elsewhere = PROFILE.replace("on_mm: 4.0", "on_mm: 5.0")
    save(path, elsewhere)
    wait_while_it_runs(page, f"{ON_SAYS} === '5'")  # the server knows of no save
    assert page.evaluate(FULL_SAYS) == "7.5"
    relay.let_save()
    wait_for_text(page, path, elsewhere.replace("[1.0, 8.0]", "[1.0, 7.5]"))
    wait_while_it_runs(page, IS_SAVED)
    assert page.evaluate(FULL_SAYS) == "7.5"
    # Answered, it holds no longer: what the file says then is shown.
    save(path, PROFILE)
    wait_while_it_runs(page, f"{FULL_SAYS} === '8'")


def test_a_mark_stays_where_it_was_put_if_the_profile_changed_while_it_was_held(relayed):
    page, relay, path = relayed
    press(page, 5)
    relay.holds_abouts = True
    save(path, PROFILE.replace("on_mm: 4.0", "on_mm: 5.0"))
    wait_on(page, lambda: relay.abouts)
    relay.let_abouts()
    page.clock.run_for(1_000)
    wait_on(page, lambda: relay.saves)
    relay.holds_abouts = True
    relay.let_save()
    wait_while_it_runs(page, IS_SAVED)
    assert page.evaluate(ON_SAYS) == "5"
    assert page.evaluate(FULL_SAYS) == "7.5"
    wait_on(page, lambda: relay.abouts)
    relay.let_abouts()
    page.clock.run_for(1_000)
    assert page.evaluate(FULL_SAYS) == "7.5"


def test_a_mark_goes_back_if_its_save_is_refused(relayed):
    page, relay, path = relayed
    press(page, 5)
    page.clock.run_for(1_000)
    wait_on(page, lambda: relay.saves)
    assert page.evaluate(FULL_SAYS) == "7.5"
    relay.let_save(instead=('"value":7.5', '"value":"far"'))
    wait_while_it_runs(page, f"{FULL_SAYS} === '8'")
    assert "needs a number" in page.inner_text("#notice")
    assert path.read_text() == PROFILE


def test_plus_and_minus_and_pause_do_without_dragging(open_page, view, driver, folder):
    path = folder / "config/neurotouch/profiles/mine.yaml"
    save(path, PROFILE)
    page = open_page(view.link)
    page.wait_for_selector("#mark-choice option >> nth=3", state="attached")
    page.select_option("#mark-choice", label="pinch from 4 mm → button a: acts from")
    page.click("#mark-more")
    page.wait_for_function(
        "() => document.getElementById('saved').textContent.startsWith("
        "'Saved in mine: pinch → button a acts from 4.1 mm. It applies now.')"
    )
    assert path.read_text() == PROFILE.replace("on_mm: 4.0", "on_mm: 4.1")
    state = "document.getElementById('driver-state').textContent"
    page.click("#pause-resume")
    page.wait_for_function(f"() => {state}.startsWith('Paused')")
    assert driver.status()["state"] == "paused"
    assert "neurotouch resume" not in page.inner_text("body")
    rest_hand(page)
    page.keyboard.press("p")
    page.wait_for_function(f"() => {state} === 'Running'")
    assert driver.status()["state"] == "running"
    save(path, PROFILE)


def test_without_edit_nothing_can_be_changed(open_page, driver):
    looking = View(driver.folder)
    try:
        page = open_page(looking.link)
        wait_for_say(page, "Push")
        assert page.locator(".draggable").count() == 0
        assert page.locator("#editor").is_hidden()
        page.close()
    finally:
        looking.end()


def test_the_keyboard_alone_reaches_everything(open_page, view):
    page = open_page(view.link)
    page.wait_for_selector(".mark.draggable")
    reached = set()
    for _ in range(80):
        page.keyboard.press("Tab")
        reached.add(
            page.evaluate(
                "() => { const e = document.activeElement;"
                " return e.dataset.mark || e.id || e.textContent.slice(0, 20); }"
            )
        )
    for control in ("on_mm", "full", "expo", "mark-choice", "mark-more", "undo", "curve-choice"):
        assert control in reached
    assert "Spacecraft" in reached


def test_the_ship_rolls_as_the_gel_is_twisted(open_page, driver, view, folder):
    page = open_page(view.page("game"))
    page.wait_for_function("() => document.querySelector('#pilot').textContent.includes('gel')")
    assert "SIMULATED" in page.inner_text("#badges")
    assert page.inner_text("#roll") == "0°"
    page.check("#sound")
    page.click("#fly")
    page.wait_for_function("() => parseInt(document.getElementById('roll').textContent) > 5")
    assert page.inner_text("#speed") != ""
    page.keyboard.press("Escape")
    page.wait_for_selector("#pause-panel:not([hidden])")


def test_the_attract_mode_flies_and_lands_with_figures(open_page, view):
    page = open_page(view.page("game"), viewport={"width": 480, "height": 480}, clock=True)
    page.click("#watch")
    page.clock.run_for(8_000)
    assert "Scripted hand: " in page.inner_text("#hand")
    assert int(page.inner_text("#rings").split()[0]) >= 1
    page.clock.run_for(50_000)
    assert page.inner_text("#result-words").startswith("12 of 12 rings")
    page.wait_for_function("() => /bit\\/s/.test(document.getElementById('figures').textContent)")
    assert "measure it" in page.inner_text("#result")


def test_the_mouse_leads_the_gel_and_the_real_line_follows(open_page, tmp_path):
    demo = Process(tmp_path, "demo", "--mouse", ready="Gamepad ready")
    try:
        link = re.search(r"Press the gel here: (\S+)", demo.said)[1]
        page = open_page(link, has_touch=True)
        assert page.inner_text(".simulated") == "SIMULATED"
        wait_for_say(page, "At rest")
        box = find_box(page.locator("#gel"))
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        step = min(box["width"], box["height"]) / 66
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + 7 * step, y, steps=8)
        wait_for_say(page, "Push right")
        page.wait_for_function(
            "() => /left stick right \\d\\d %/.test(document.getElementById('say').textContent)"
        )
        page.mouse.up()
        wait_for_say(page, "At rest")
        page.focus("#gel")
        page.keyboard.down("e")
        wait_for_say(page, "Twist clockwise")
        page.keyboard.down("Control")
        page.keyboard.up("e")
        time.sleep(1.0)
        wait_for_say(page, "Twist clockwise")  # held: once let go of, it would not come back
        page.keyboard.up("Control")
        wait_for_say(page, "At rest")
        fingers = page.context.new_cdp_session(page)
        touch(fingers, page, x, y, lambda t: (6 + 6 * t, 0.0))  # two fingers open
        wait_for_say(page, "Zoom")
        lift(fingers)
        wait_for_say(page, "At rest")
        touch(fingers, page, x, y, lambda t: (12.0, 0.6 * t))  # and turn
        wait_for_say(page, "Twist clockwise")
        lift(fingers)
        wait_for_say(page, "At rest")
        page.check("#resting")
        page.wait_for_function("() => !document.getElementById('say').textContent.includes('rest')")
        page.uncheck("#resting")
        wait_for_say(page, "At rest")
        page.mouse.move(x, y)

        def pinches() -> bool:
            page.mouse.wheel(0, 60)  # which lets go by itself soon after the last one
            return page.inner_text("#say").startswith("Pinch")

        wait_on(page, pinches)
        page.wait_for_function(
            "() => /mouse to pad/.test(document.getElementById('lag').textContent)"
        )
        page.close()
    finally:
        demo.end()
    assert demo.process.returncode == 0
    assert demo.said.rstrip().endswith("The pad is neutral.")
    assert not list((tmp_path / "run").glob("page.json"))


def touch(session, page, x, y, way) -> None:
    """Lays two fingers down and moves them: ``way(t)`` is their distance in mm and their turn."""
    box = find_box(page.locator("#gel"))
    step = min(box["width"], box["height"]) / 66
    for i in range(13):
        far, turn = way(i / 12)
        dx, dy = far * step * math.cos(turn), far * step * math.sin(turn)
        points = [{"x": x + dx, "y": y + dy, "id": 0}, {"x": x - dx, "y": y - dy, "id": 1}]
        kind = "touchMove" if i else "touchStart"
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        time.sleep(0.03)


def lift(session) -> None:
    session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


def test_a_frozen_or_killed_page_never_touches_the_line(tmp_path, folder):
    shutil.copytree(folder / "config", tmp_path / "config")
    driver = Driver(tmp_path)
    view = View(tmp_path)
    try:
        from websockets.sync.client import connect

        with connect(
            f"ws://127.0.0.1:{view.port}/stream", origin=f"http://127.0.0.1:{view.port}"
        ) as socket:
            socket.send(f'{{"token": "{view.token}", "hz": 60}}')
            for _ in range(30):
                socket.recv(LIMIT_S)
            os.kill(view.process.pid, signal.SIGSTOP)
            before = driver.status()
            driver.wait(lambda: driver.status()["slices"] > before["slices"] + 200)
            driver.wait(lambda: driver.status()["silent_s"] == 0.0)
            os.kill(view.process.pid, signal.SIGCONT)
            states = [socket.recv(LIMIT_S) for _ in range(30)]
            assert any(isinstance(state, bytes) for state in states)
        view.process.kill()
        view.process.wait()
        before = driver.status()
        driver.wait(lambda: driver.status()["slices"] > before["slices"] + 100)
    finally:
        view.process.kill()
        driver.end()
    assert "Traceback" not in driver.said


@pytest.mark.parametrize("path", ["", "live", "gel", "game"])
@pytest.mark.parametrize(
    ("secret", "said"), [("", "link is missing"), ("#k=wrong", "its link is wrong")]
)
def test_a_page_without_its_whole_link_says_what_to_open(view, open_page, path, secret, said):
    page = open_page(f"{view.root}{path}{secret}")
    wait_for(page, "notice", said)
    assert page.inner_text("#notice").endswith(
        "Open NeuroTouch again, or the whole link that the terminal shows."
    )
