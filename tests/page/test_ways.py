"""Each way through the first page, by mouse, keyboard, finger and one switch; steps are counted.

The numbers are those of decision 047. Pages close before their server ends, so a test names
`open_page` after the server.
"""

from tests.page.waiting import wait_for, wait_on

MOST_STEPS = 60  # of a search for one control: then it cannot be reached


class Mouse:
    """Clicks, counted; a list takes two, one to open it and one to choose."""

    def __init__(self, page) -> None:
        self.page, self.count = page, 0

    def click(self, selector: str) -> None:
        self.page.click(selector)
        self.count += 1

    def choose(self, selector: str, value: str) -> None:
        self.page.select_option(selector, value)
        self.count += 2


class Keys:
    """Keys, counted. One switch is the same with two of them: Tab steps, Enter chooses."""

    def __init__(self, page) -> None:
        self.page, self.count = page, 0
        self.heard: list[tuple[str, str]] = []
        self._tree = page.context.new_cdp_session(page)

    def press(self, key: str) -> None:
        self.page.keyboard.press(key)
        self.count += 1

    def go_to(self, selector: str) -> None:
        for _ in range(MOST_STEPS):
            self.press("Tab")
            if self.page.evaluate("wanted => document.activeElement.matches(wanted)", selector):
                self.hear()
                return
        raise AssertionError(f"Tab does not reach {selector}")

    def hear(self) -> None:
        """Notes role and name of what has the focus, as a screen reader gets them."""
        nodes = self._tree.send("Accessibility.getFullAXTree")["nodes"]
        focused = [
            (node["role"]["value"], node["name"]["value"])
            for node in nodes
            if {"focused", True}
            <= {
                x
                for each in node.get("properties", ())
                if each["name"] == "focused"
                for x in (each["name"], each["value"]["value"])
            }
        ]
        self.heard.append(focused[-1])


def check_bound(bare, page) -> None:
    wait_for(page, "saved", "It applies now.")
    path = bare.folder / "config/neurotouch/profiles/spacecraft.yaml"
    assert "button: b" in path.read_text()
    wait_for(page, "driver-state", "Running")


def test_three_clicks_and_a_movement_bind_it_with_the_mouse(bare, open_page):
    page = open_page(bare.home)
    mouse = Mouse(page)
    mouse.click("#start-mouse")
    page.wait_for_selector("#gel:not([hidden])")
    mouse.click("#by-doing")
    wait_for(page, "driver-state", "Paused")
    x, y, px_mm = find_middle(page)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + STRENGTH_MM * px_mm, y, steps=8)
    page.wait_for_selector("[data-movement=push_right].made")
    page.mouse.up()
    page.wait_for_selector("#chooser[open]")
    assert page.inner_text("#chooser-title") == "Push right does …"
    mouse.click("#outputs button:text-is('B')")
    check_bound(bare, page)
    assert mouse.count == 3


def test_the_keyboard_alone_binds_a_movement_and_a_screen_reader_hears_each_step(bare, open_page):
    page = open_page(bare.home)
    page.wait_for_selector("#start-mouse:not([hidden])")
    keys = Keys(page)
    keys.go_to("#start-mouse")
    keys.press("Enter")
    page.wait_for_selector("#by-doing:not([hidden])")
    page.wait_for_function("() => document.activeElement.id === 'fly'")
    keys.hear()
    keys.go_to("#by-doing")
    keys.press("Enter")
    wait_for(page, "driver-state", "Paused")
    keys.hear()
    page.keyboard.down("-")  # the movement
    page.wait_for_selector("[data-movement=pinch].made")
    page.keyboard.up("-")
    page.wait_for_selector("#chooser[open]")
    keys.go_to("#outputs button:nth-child(2)")
    keys.press("Enter")
    check_bound(bare, page)
    assert keys.heard == [
        ("button", "Try it without a camera"),
        ("link", "Fly the spacecraft"),
        ("button", "Make a movement to change it"),
        (
            "application",
            "The gel: press it with mouse or fingers, or with the arrow keys, Q, E, plus and minus",
        ),
        ("button", "B"),
    ]
    assert keys.count == 26


def test_one_switch_binds_a_movement_and_flies(bare, open_page):
    """A switch steps with Tab and chooses with Enter; no key is held, nothing is timed."""
    page = open_page(bare.home)
    page.wait_for_selector("#start-mouse:not([hidden])")
    switch = Keys(page)
    switch.go_to("#start-mouse")
    switch.press("Enter")
    page.wait_for_selector("#by-doing:not([hidden])")
    page.wait_for_function("() => document.activeElement.id === 'fly'")
    switch.go_to("#by-doing")
    switch.press("Enter")
    wait_for(page, "driver-state", "Paused")
    switch.go_to("[data-gesture=pinch]")
    switch.press("Enter")
    page.wait_for_selector("#chooser[open]")
    switch.go_to("#outputs button:nth-child(2)")
    switch.press("Enter")
    check_bound(bare, page)
    assert switch.count == 33
    switch.go_to("#fly")
    switch.press("Enter")
    page.wait_for_selector("#gel-panel:not([hidden])")
    switch.go_to("#pace")
    page.keyboard.press("Home")  # the slowest, which needs no hurry
    switch.go_to("#fly")
    switch.press("Enter")
    switch.go_to("#gel-panel summary")
    switch.press("Enter")
    names = {(-1, 0): "push_left", (1, 0): "push_right", (0, -1): "push_up", (0, 1): "push_down"}

    def steer(right: int, down: int) -> None:
        way = next((way for way in [(right, 0), (0, down)] if way in names), None)
        if way:
            switch.go_to(f"[data-gesture={names[way]}]")
            switch.press("Enter")
            page.wait_for_timeout(900)  # the press ends by itself

    fly_one_ring(page, steer)


def test_from_the_icon_to_push_only_playing_without_a_command(bare, open_page):
    """At most eight clicks, the one on the icon included."""
    page = open_page(bare.home)
    mouse = Mouse(page)
    mouse.count = 1  # the icon
    page.wait_for_selector("#profile-choice option[value=push-only]", state="attached")
    mouse.choose("#profile-choice", "push-only")
    mouse.click("#profile-use")
    wait_for(page, "saved", "it applies from the next start")
    mouse.click("#start-mouse")
    wait_for(page, "badges", "profile push-only")
    wait_for(page, "driver-state", "Running")
    assert mouse.count == 5


WAYS = {"left": (-1, 0), "right": (1, 0), "up": (0, -1), "down": (0, 1)}
STRENGTH_MM = 8.0
GEL_MM = 66.0  # across the canvas


def fly_one_ring(page, steer) -> None:
    """Follows the advice until a ring is passed; `steer` is told where to push, in shares."""
    page.wait_for_function("() => document.body.dataset.mode === 'flying'")

    def follow() -> bool:
        advice = page.inner_text("#advice").lower()
        words = advice.replace("-", " ").split() if "push" in advice else []
        ways = [WAYS[word] for word in words if word in WAYS]
        steer(sum(x for x, _ in ways), sum(y for _, y in ways))
        return int(page.inner_text("#rings").split()[0]) >= 1

    wait_on(page, follow)
    steer(0, 0)


def find_middle(page) -> tuple[float, float, float]:
    """The middle of the gel, and how many pixels are a millimetre there."""
    box = page.locator("#gel").bounding_box()
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    return *middle, min(box["width"], box["height"]) / GEL_MM


def press_keys(page, wanted: set[str], held: set[str]) -> None:
    for key in held - wanted:
        page.keyboard.up(key)
    for key in wanted - held:
        page.keyboard.down(key)
    held.clear()
    held.update(wanted)


def test_three_clicks_and_the_mouse_fly_the_first_ring(bare, open_page):
    page = open_page(bare.home)
    page.click("#start-mouse")
    page.click("#fly")
    page.wait_for_selector("#gel-panel:not([hidden])")
    page.click("#fly")
    x, y, px_mm = find_middle(page)
    at = [0, 0]

    def steer(right: int, down: int) -> None:
        if [right, down] == at:
            return
        page.mouse.up()
        at[:] = right, down
        if right or down:
            page.mouse.move(x, y)
            page.mouse.down()
            far = STRENGTH_MM * px_mm
            page.mouse.move(x + right * far, y + down * far, steps=4)

    fly_one_ring(page, steer)


def test_the_keyboard_alone_flies_the_first_ring(bare, open_page):
    """Tab to the first button, Enter three times, then the arrow keys."""
    page = open_page(bare.home)
    page.wait_for_selector("#start-mouse:not([hidden])")
    keys = Keys(page)
    keys.go_to("#start-mouse")
    keys.press("Enter")
    page.wait_for_selector("#fly:not([hidden])")
    assert page.evaluate("document.activeElement.id") == "fly"
    keys.press("Enter")
    page.wait_for_selector("#gel-panel:not([hidden])")
    keys.press("Enter")
    arrows = {(-1, 0): "ArrowLeft", (1, 0): "ArrowRight", (0, -1): "ArrowUp", (0, 1): "ArrowDown"}
    held: set[str] = set()

    def steer(right: int, down: int) -> None:
        wanted = {arrows[way] for way in [(right, 0), (0, down)] if way in arrows}
        press_keys(page, wanted, held)

    fly_one_ring(page, steer)


def test_a_finger_on_a_phone_flies_the_first_ring(bare, open_page):
    phone = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}
    page = open_page(bare.home, **phone)
    page.tap("#start-mouse")
    page.tap("#fly")
    wait_for(page, "pilot", "the gel")
    page.tap("#fly")
    page.wait_for_selector("#gel-panel:not([hidden])")
    x, y, px_mm = find_middle(page)
    finger = page.context.new_cdp_session(page)
    at = [0, 0]

    def touch(kind: str, *points: tuple[float, float]) -> None:
        finger.send(
            "Input.dispatchTouchEvent",
            {"type": kind, "touchPoints": [{"x": x, "y": y} for x, y in points]},
        )

    def steer(right: int, down: int) -> None:
        if [right, down] == at:
            return
        if any(at):
            touch("touchEnd")
        at[:] = right, down
        if right or down:
            touch("touchStart", (x, y))
            for step in (0.25, 0.5, 0.75, 1.0):
                far = step * STRENGTH_MM * px_mm
                touch("touchMove", (x + right * far, y + down * far))

    fly_one_ring(page, steer)
