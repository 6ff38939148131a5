"""Every page in every way of seeing it: nothing overlaps, is cut, or scrolls sideways."""

import json

import pytest

from neurotouch_hid.page.output_choices import list_outputs
from neurotouch_hid.page.pictures import draw_code
from neurotouch_hid.page.profile_view import describe_profile
from neurotouch_hid.profile.reading.library import find_shipped_folder
from tests.page.played import HEALTH
from tests.page.waiting import wait_for

NAMES = ["", "live", "gel", "game", "sheet"]
WAYS = {
    "100": {"viewport": {"width": 1280, "height": 860}},
    "200": {"viewport": {"width": 640, "height": 430}},
    "400": {"viewport": {"width": 320, "height": 256}},
    "1000 px": {"viewport": {"width": 1000, "height": 900}},
    "small": {"viewport": {"width": 800, "height": 600}},
    "phone": {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True},
    "turned": {"viewport": {"width": 844, "height": 390}, "has_touch": True, "is_mobile": True},
    "dark": {"viewport": {"width": 1280, "height": 860}, "color_scheme": "dark"},
    "contrast": {"viewport": {"width": 1280, "height": 860}, "contrast": "more"},
    "forced": {"viewport": {"width": 1280, "height": 860}, "forced_colors": "active"},
    "calm": {"viewport": {"width": 1280, "height": 860}, "reduced_motion": "reduce"},
}
RULED = {"100", "400", "phone", "dark", "contrast", "forced"}
"""The ways that are held against the accessibility rules, which take half of the time: all colours,
and the sizes at both ends."""
TEXTS = """() => {
    const found = [];
    const boxes = [];
    const root = document.querySelector('dialog[open]') || document.body;
    const walker = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        const holder = node.parentElement;
        if (!node.data.trim() || holder.closest('.unseen, .skip, option, svg')) continue;
        if (!holder.checkVisibility({visibilityProperty: true})) continue;
        const range = document.createRange();
        range.selectNodeContents(node);
        for (const box of range.getClientRects()) boxes.push([node, box, holder]);
    }
    const words = node => node.data.trim().slice(0, 40);
    boxes.forEach(([a, p], i) => boxes.slice(i + 1).forEach(([b, q]) => {
        const wide = Math.min(p.right, q.right) - Math.max(p.left, q.left);
        const high = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
        if (a !== b && wide > 2 && high > 4) found.push(`over: ${words(a)} | ${words(b)}`);
    }));
    for (const [node, box, holder] of boxes) {
        if (box.left < -1 || box.right > innerWidth + 1) found.push(`outside: ${words(node)}`);
        for (let each = holder; each !== document.body; each = each.parentElement) {
            const {overflowX, overflowY} = getComputedStyle(each);
            const edge = each.getBoundingClientRect();
            const isWide = box.left < edge.left - 1 || box.right > edge.right + 1;
            const isHigh = box.top < edge.top - 1 || box.bottom > edge.bottom + 1;
            if (overflowX !== 'visible' && isWide) found.push(`cut: ${words(node)}`);
            if (['hidden', 'clip'].includes(overflowY) && isHigh) found.push(`cut: ${words(node)}`);
            if (each.matches('section, header') && isWide) found.push(`leaves: ${words(node)}`);
        }
    }
    const context = document.createElement('canvas').getContext('2d');
    for (const each of root.querySelectorAll('select')) {
        if (!each.checkVisibility() || each.id === 'mark-choice') continue; // has its name below
        context.font = getComputedStyle(each).font;
        const text = each.selectedOptions[0].textContent;
        const room = each.clientWidth - parseFloat(getComputedStyle(each).paddingLeft) - 18;
        if (context.measureText(text).width > room) found.push(`cut in its list: ${text}`);
    }
    if (document.documentElement.scrollWidth > innerWidth) found.push('scrolls sideways');
    return found;
}"""

GEL = """(mayScroll) => {
    const found = [];
    const gel = document.getElementById('gel').getBoundingClientRect();
    if (gel.width < 100) found.push('small');
    if (!mayScroll && (gel.top < 0 || gel.bottom > innerHeight)) found.push('out of view');
    const others = '.instruments strong, .instruments span, #advice, #hand, #pause, header *';
    for (const each of document.querySelectorAll(others)) {
        if (each.children.length || !each.checkVisibility()) continue;
        const range = document.createRange();
        range.selectNodeContents(each);
        for (const box of range.getClientRects()) {
            const wide = Math.min(gel.right, box.right) - Math.max(gel.left, box.left);
            const high = Math.min(gel.bottom, box.bottom) - Math.max(gel.top, box.top);
            if (wide > 2 && high > 2) found.push(`over the gel: ${each.textContent}`);
        }
    }
    return found;
}"""


def check_texts(page, moment: str) -> None:
    assert page.evaluate(TEXTS) == [], moment


def check_rules(page, moment: str) -> None:
    from axe_playwright_python.sync_playwright import Axe

    found = Axe().run(page)
    assert found.violations_count == 0, f"{moment}\n{found.generate_report()}"


def show_much(driver, **changes) -> None:
    """A state with long words everywhere."""
    view = describe_profile(find_shipped_folder() / "slow-and-steady.yaml", edit=True)
    profiles = [{"name": "slow-and-steady", "own": True, "first": True, "about": "Calm. " * 20}]
    driver.tell(about=view, outputs=list_outputs(), profiles=profiles)
    driver.show(
        profile=view["profile"],
        layer=view["layers"][0]["name"],
        say="Push down-right 6.8 mm, 2 fingers → left stick right 74 % down 31 %",
        actions=[
            (1_000_000, "ignored", "pinch then pinch -> button a", "lasted 90 ms < 120 ms"),
            (12_300_000, "pressed", "push left from 9 mm -> toggle layer menu", ""),
        ],
        slow={
            **HEALTH,
            "events_hz": 1_523_208,
            "stages": {name: [10.25, 125.5] for name in ("rest", "tracker", "gesture", "profile")},
            "copilot": "Microsoft X-Box 360 pad, by a helper",
            "rumble": {"strong": 0, "weak": 0},
            "hand_ms": [10.0, 14.0],
        },
        **changes,
    )


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", NAMES)
def test_a_page_can_be_read(play, name, way):
    page, driver = play(name, **WAYS[way])
    show_much(driver)
    wait_for(page, "badges", "slow-and-steady")
    page.wait_for_function("() => !document.querySelector('#actions')?.textContent.includes('yet')")
    if name == "live":
        choice = page.locator("#mark-choice option >> nth=0").text_content()
        assert page.text_content("#mark-name") == choice
        assert page.is_visible("#mark-name") == (WAYS[way]["viewport"]["width"] <= 600)
    check_texts(page, "at first")
    if way in RULED:
        check_rules(page, "at first")
    if not name:
        page.locator("[data-movement=push_down] .row button").click()
        page.select_option("#group-choice", "Sticks")
        check_texts(page, "choosing")
        if way in RULED:
            check_rules(page, "choosing")
        page.keyboard.press("Escape")
    if name == "game":
        page.click("#fly")
        wait_for(page, "advice", "Push")
        check_texts(page, "in flight")
        assert page.evaluate(GEL, way == "400") == []
        page.click("#gel-panel summary")
        check_texts(page, "in flight, gestures as buttons")
    page.click("#page-settings summary")
    show_much(driver, state="paused")
    wait_for(page, "driver-state", "Paused")
    driver.tell(refused="'tremor' is not a layer of this profile, so nothing was saved.")
    page.wait_for_selector("#notice:not([hidden])")
    check_texts(page, "paused, with a notice and the settings")
    if way in RULED:
        check_rules(page, "paused, with a notice and the settings")
    if name == "game":
        page.evaluate(
            """() => {
                document.body.dataset.mode = 'result';
                for (const id of ['pause-panel', 'result']) {
                    document.getElementById(id).hidden = id !== 'result';
                }
                document.getElementById('result-words').textContent = '12 of 12 rings in 51 s.';
                document.getElementById('figures').innerHTML =
                    '<dt>Throughput (ISO 9241-411)</dt><dd>0.27 bit/s</dd>';
            }"""
        )
        check_texts(page, "landed")


FINDINGS = [
    {
        "check": "udev rule",
        "status": "WARNING",
        "sentence": "No udev rule gives /dev/uinput to the person at the machine.",
        "fix": "Install ours, as 'neurotouch setup' does.",
        "commands": [
            "sudo install -D -m 644 /usr/lib/python3/dist-packages/neurotouch_hid/rules.d/"
            "70-neurotouch-uinput.rules /etc/udev/rules.d/70-neurotouch-uinput.rules",
            "sudo udevadm control --reload",
        ],
    }
]
CHOICES = [
    "Zoom goes 31 % as far as Pinch. What shall be done?",
    "  1. Keep it: with its own range, a small movement counts as a whole one",
    "  2. Let a long Pinch do what Zoom does in the profile 'default'",
    "Number, 1 to 2:",
]
CODE = draw_code(f"http://192.168.100.100:78780/#k={'k' * 32}")


def show_values(driver) -> None:
    values = {"filter": "strong", "timing": "slow", "neutral": "resting", "fatigue": "auto"}
    driver.tell(own={"values": {**values, "feedback.sound": "speech"}})
    driver.tell(own={"fault": "Your own values cannot be read. Line 2, 'filtr': unknown key."})


def show_calibration(driver) -> None:
    for line in ("Step 3 of 10. Push left, as far as is comfortable. Twice.", "good: 6.2 mm"):
        driver.tell(program={"name": "calibrate", "line": line})


def show_choices(driver) -> None:
    for line in CHOICES:
        driver.tell(program={"name": "calibrate", "line": line})


def show_findings(driver) -> None:
    driver.tell(program={"name": "calibrate", "code": 0})
    driver.tell(program={"name": "check", "line": f"Checking …\n{json.dumps(FINDINGS)}"})
    driver.tell(program={"name": "check", "code": 0})


def show_code(driver) -> None:
    link = f"http://192.168.100.100:78780/#k={'k' * 32}"
    driver.tell(remote={"link": link, "code": CODE, "minutes": 60})


def show_waiting(driver) -> None:
    kind = {"kind": "no_right", "next": "", "mend": "setup"}
    driver.tell(driver=False, situation={**kind, "text": "Camera found but not readable."})
    driver.tell(hello=True, edit=True, far=True)


MOMENTS = {
    "the mouse gel": (lambda driver: None, "#gel"),
    "own values": (show_values, "#own-mend"),
    "measuring": (show_calibration, "#answers"),
    "measuring, with a choice": (show_choices, "#choices button"),
    "the doctor's findings": (show_findings, "#findings pre"),
    "a phone": (show_code, "#code"),
    "a right is missing": (show_waiting, "#mend"),
}


@pytest.mark.parametrize("way", ["100", "200", "400", "forced", "phone"])
def test_every_moment_of_the_first_page_can_be_read(play, way):
    page, driver = play("", **WAYS[way])
    show_much(driver)
    wait_for(page, "badges", "slow-and-steady")
    page.click("#gesture-buttons summary")
    for moment, (show, shown) in MOMENTS.items():
        show(driver)
        page.wait_for_selector(f"{shown} >> nth=0")
        check_texts(page, moment)
        check_rules(page, moment)


LIGHTS = """(canvas) => {
    const {width, height} = canvas;
    const {data} = canvas.getContext('2d').getImageData(0, 0, width, height);
    const middle = Math.floor(height / 2) * width * 4;
    return new Set(data.slice(middle, middle + width * 4).filter((_, i) => i % 4 === 0)).size;
}"""
PLATES = """() => {
    const plate = getComputedStyle(document.body).backgroundColor;
    const hidden = (button) => getComputedStyle(button).color === plate;
    return [...document.querySelectorAll('button')].filter(hidden).map((each) => each.textContent);
}"""


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_forced_colours_hide_no_word_and_no_dot(play, scheme):
    """The browser puts a plate of the page's colour behind words, and none into a canvas."""
    page, driver = play("live", forced_colors="active", color_scheme=scheme)
    show_much(driver)
    drawn = f"() => ({LIGHTS})(document.getElementById('disc')) > 2"
    page.wait_for_function(drawn, timeout=60_000)
    for name in ("", "sheet", "game"):
        page.goto(page.url.replace("live", name))
        page.wait_for_selector("button.primary", state="attached")
        assert page.evaluate(PLATES) == []


def test_nothing_moves_by_itself_for_those_who_want_that(play):
    page, _ = play(
        "game", clock=True, reduced_motion="reduce", viewport={"width": 480, "height": 480}
    )
    for _ in range(1_000):  # 50 s by the longest steps that the game takes as they are
        page.clock.fast_forward(50)
    assert page.is_visible("#start")  # else the ship would fly by itself
    moving = "document.getAnimations().length"
    assert page.evaluate(moving) == 0
