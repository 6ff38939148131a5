"""The marks in the bars and at the curve: each can be taken, told apart and named."""

import pytest

from neurotouch_hid.page.profile_view import describe_profile
from neurotouch_hid.profile.reading.library import find_shipped_folder
from tests.page.waiting import wait_on

WIDTHS = {
    "desk": {"viewport": {"width": 1280, "height": 900}},
    "phone": {"viewport": {"width": 390, "height": 844}, "has_touch": True},
    "enlarged": {"viewport": {"width": 320, "height": 256}},
}
SLIDERS = "[role=slider].mark"
TROUBLE = """() => {
    const found = [];
    const boxes = [];
    const names = new Set();
    for (const each of document.querySelectorAll('[role=slider].mark')) {
        const name = each.getAttribute('aria-label');
        if (names.has(name)) found.push(`twice: ${name}`);
        names.add(name);
        each.scrollIntoView({block: 'center'});
        const box = each.getBoundingClientRect();
        if (box.width < 24 || box.height < 24) found.push(`small: ${name}`);
        if (box.left < 0 || box.right > innerWidth) found.push(`outside: ${name}`);
        const middle = [box.left + box.width / 2, box.top + box.height / 2];
        for (const [dx, dy] of [[0, 0], [-11, 0], [11, 0], [0, -11], [0, 11]]) {
            const there = document.elementFromPoint(middle[0] + dx, middle[1] + dy);
            if (there !== each) found.push(`covered: ${name} by ${there.className}`);
        }
    }
    for (const each of document.querySelectorAll('.row-name')) {
        if (each.scrollWidth > each.clientWidth) found.push(`cut: ${each.textContent}`);
    }
    return [found, names.size];
}"""


def show_profile(page, driver, name: str, layer: str | None = None) -> None:
    view = describe_profile(find_shipped_folder() / f"{name}.yaml", edit=True)
    driver.tell(about=view)
    driver.show(profile=name, layer=layer or view["layers"][0]["name"])


@pytest.mark.parametrize("width", WIDTHS)
def test_each_mark_of_each_shipped_profile_can_be_taken_and_has_its_own_name(play, width):
    page, driver = play("live", **WIDTHS[width])
    n_marks = 0
    for path in sorted(find_shipped_folder().glob("*.yaml")):
        view = describe_profile(path, edit=True)
        driver.tell(about=view)
        for layer in view["layers"]:
            driver.show(profile=view["profile"], layer=layer["name"])
            key = layer["bindings"][0]["key"]
            page.wait_for_function(
                "([profile, key]) => badges.textContent.endsWith(profile)"
                " && document.querySelector(`.bars [data-key='${key}']`)",
                arg=[view["profile"], key],
            )
            trouble, n = page.evaluate(TROUBLE)
            assert trouble == [], f"{path.stem}, layer {layer['name']}"
            n_marks += n
    assert n_marks > 200


def test_shape_and_label_tell_the_marks_apart_without_colours(play):
    page, driver = play()
    show_profile(page, driver, "default")
    page.wait_for_selector("[data-movement=pinch] .mark-full")
    looks = {
        mark: page.locator(f"[data-movement=pinch] .mark-{mark}").evaluate(
            "each => [each.textContent, getComputedStyle(each).borderRadius,"
            " each.closest('.up') !== null]"
        )
        for mark in ("on_mm", "off_mm", "rest", "full")
    }
    assert looks == {
        "on_mm": ["on", "3px", True],
        "off_mm": ["off", "3px", True],
        "rest": ["rest", "12px", False],
        "full": ["full", "12px", False],
    }


def read_values(page, mark: str) -> list[str]:
    """What all sliders of the left stick's range show, those of the curve too."""
    return page.locator(f"{SLIDERS}.mark-{mark}[aria-label*='push → stick left']").evaluate_all(
        "all => all.map(each => each.getAttribute('aria-valuenow'))"
    )


def test_all_marks_of_a_value_move_at_once(play):
    page, driver = play(clock=True)
    show_profile(page, driver, "push-only")
    page.clock.run_for(500)
    assert read_values(page, "rest") == ["1"] * 5  # four directions, and the curve
    page.locator("[data-movement=push_up] .mark-rest").focus()
    page.keyboard.press("ArrowRight")
    assert read_values(page, "rest") == ["1.1"] * 5
    assert page.inner_text("#mark-value") == "1.1 mm"
    page.keyboard.press("End")
    assert read_values(page, "rest") == ["5.5"] * 5
    page.keyboard.press("Home")
    assert read_values(page, "rest") == ["0"] * 5
    assert driver.asked == []
    page.clock.run_for(1_000)
    wait_on(page, lambda: driver.asked)
    asked = driver.answer(saved="Saved.")
    assert (asked["mark"], asked["value"]) == ("rest", 0)
    page.click("#mark-more")
    assert read_values(page, "rest") == ["0.1"] * 5


@pytest.mark.parametrize("by", ["mouse", "touch"])
@pytest.mark.parametrize("mark", ["off_mm", "full"])
def test_of_two_marks_at_one_place_each_is_dragged(play, by, mark):
    page, driver = play(has_touch=True)
    show_profile(page, driver, "push-only")
    handle = page.locator(f"[data-movement=push_left] .mark-{mark}")
    handle.wait_for()
    assert handle.get_attribute("aria-valuenow") == "6"
    box = handle.bounding_box()
    lane = page.locator("[data-movement=push_left] .marks").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    far = -lane["width"] * 2 / 15
    if by == "mouse":
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + far, y, steps=4)
        page.mouse.up()
    else:
        finger = page.context.new_cdp_session(page)
        for kind, at in (("touchStart", x), ("touchMove", x + far / 2), ("touchMove", x + far)):
            points = [{"x": at, "y": y}]
            finger.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        finger.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    wait_on(page, lambda: driver.asked)
    asked = driver.answer(saved="Saved.")
    assert (asked["do"], asked["mark"]) == ("set", mark)
    assert asked["value"] == pytest.approx(4.0, abs=0.1)


def test_a_held_mark_goes_as_far_as_the_pointer_though_the_page_moves(play):
    page, driver = play(viewport={"width": 1280, "height": 2000})
    show_profile(page, driver, "spacecraft")
    handle = page.locator("#curve-handles .mark-expo")
    before = float(handle.get_attribute("aria-valuenow"))
    box, plot = handle.bounding_box(), page.locator("#curve-handles").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.evaluate("document.querySelector('main').style.marginTop = '100px'")
    page.mouse.move(x + 1, y)
    assert float(handle.get_attribute("aria-valuenow")) == before
    page.mouse.move(x, y + 0.1 * 0.375 * plot["height"])
    assert float(handle.get_attribute("aria-valuenow")) == pytest.approx(before + 0.1, abs=0.011)
    page.mouse.up()
