"""Golden timelines of presses and modes: what counts, when, and what is said of the rest."""

import re

import pytest

from neurotouch_hid.profile import Mapping, UserSettings, rehearse
from tests.profile.stage import RAW, make_profile, run, tell

# A tap of the script is on for about 90 ms; `on` and `off` are the usual 2.5 and 1.5 mm.
TAP = "pinch 5mm tap"


def long(ms: int) -> str:
    return f"pinch 5mm 40ms hold {ms}ms"


@pytest.mark.parametrize(
    ("when", "script", "expected"),
    [
        ("", long(300), ["20 button a down", "370 button a up"]),
        ("press: tap", TAP, ["110 button a down", "160 button a up"]),
        ("press: tap", long(300),
         ["370 ignored: pinch tap -> button a, because lasted 350 ms > 220 ms"]),
        ("press: hold", long(500), ["370 button a down", "570 button a up"]),
        ("press: hold", long(200),
         ["270 ignored: pinch hold -> button a, because held 250 ms < 350 ms"]),
        ("press: hold, hold_ms: 100", long(200), ["120 button a down", "270 button a up"]),
        ("press: long", long(1000), ["820 button a down", "1070 button a up"]),
        ("press: double", f"{TAP}; rest 100ms; {long(200)}",
         ["240 button a down", "490 button a up"]),
        ("press: double", f"{TAP}; rest 400ms; {TAP}",
         ["540 ignored: pinch double -> button a, because pause of 430 ms > 300 ms"]),
        ("press: double", f"{TAP}; rest 20ms; {TAP}",
         ["160 ignored: pinch double -> button a, because pause of 50 ms < 80 ms"]),
        ("accept_ms: 100", long(300), ["120 button a down", "370 button a up"]),
        ("accept_ms: 100", TAP, ["110 ignored: pinch -> button a, because lasted 90 ms < 100 ms"]),
        ("ignore_repeat_ms: 200", f"{TAP}; rest 100ms; {TAP}; rest 300ms; {TAP}",
         ["20 button a down", "110 button a up",
          "240 ignored: pinch -> button a, because repeat 130 ms < 200 ms",
          "660 button a down", "750 button a up"]),
        ("trigger: release", long(300), ["370 button a down", "420 button a up"]),
        ("level: hard", "pinch 8mm 100ms", ["70 button a down", "260 button a up"]),
        ("phase: hold", "pinch 8mm 100ms hold 300ms", ["180 button a down", "430 button a up"]),
        ("min_speed_mm_s: 60", "pinch 8mm 2s", []),
        ("min_speed_mm_s: 60", "pinch 8mm 60ms", ["30 button a down", "210 button a up"]),
    ],
)  # fmt: skip
def test_presses(when: str, script: str, expected: list[str]) -> None:
    profile = make_profile(f"when: {{gesture: pinch, {when or 'off_mm: 1.5'}}}, do: {{button: a}}")
    assert tell(profile, script) == expected


def test_a_tap_waits_only_where_a_double_could_follow() -> None:
    tap, double = "when: {gesture: pinch, press: tap}", "when: {gesture: pinch, press: double}"
    profile = make_profile(f"{tap}, do: {{button: a}}", f"{double}, do: {{button: b}}")
    assert tell(profile, TAP + "; rest 400ms") == ["410 button a down", "460 button a up"]
    assert tell(profile, f"{TAP}; rest 100ms; {TAP}; rest 500ms") == [
        "240 button b down",
        "240 ignored: pinch tap -> button a, because another tap follows",
        "330 button b up",
    ]
    tremor = tell(profile, f"{TAP}; rest 20ms; {TAP}; rest 500ms")
    assert [line for line in tremor if "ignored" not in line] == [
        "410 button a down",
        "460 button a up",
    ]


def test_a_hold_beside_a_long_one_acts_when_it_ends_sooner() -> None:
    profile = make_profile(
        "when: {gesture: pinch, press: hold}, do: {button: a}",
        "when: {gesture: pinch, press: long}, do: {button: b}",
    )
    outputs = [line for line in tell(profile, long(500)) if "ignored" not in line]
    assert outputs == ["570 button a down", "620 button a up"]
    outputs = [line for line in tell(profile, long(1000)) if "ignored" not in line]
    assert outputs == ["820 button b down", "1070 button b up"]


def test_soft_and_hard_exclude_each_other() -> None:
    profile = make_profile(
        "when: {gesture: pinch, level: soft}, do: {button: a}",
        "when: {gesture: pinch, level: hard}, do: {button: b}",
    )
    soft = tell(profile, "pinch 4mm 100ms hold 300ms")
    assert [line.split(" ", 1)[1] for line in soft] == ["button a down", "button a up"]
    hard = tell(profile, "pinch 9mm 150ms hold 300ms")
    assert {line.split(" ", 1)[1] for line in hard} == {"button b down", "button b up"}
    quick = tell(profile, "pinch 4mm tap")
    assert [line.split(" ", 1)[1] for line in quick] == ["button a down", "button a up"]


def test_a_gesture_that_turns_into_another_is_no_release() -> None:
    profile = make_profile(
        "when: {gesture: push, direction: left, trigger: release}, do: {button: a}"
    )
    away = "push left 5mm 100ms hold 200ms release 0ms; push down 5mm 0ms hold 200ms"
    assert tell(profile, away) == [
        "300 ignored: push left -> button a, because turned into another gesture before it ended"
    ]
    assert tell(profile, "push left 5mm 100ms hold 200ms")[0].endswith("button a down")


def test_a_weak_release_is_enough_and_a_rise_presses_again() -> None:
    profile = make_profile("when: {gesture: pinch, release: {}}, do: {button: a}")
    weak = (
        "pinch 8mm 50ms hold 200ms release 0ms; pinch 5mm 0ms hold 200ms; pinch 7mm 0ms hold 100ms"
    )
    words = [line.split(" ", 1)[1] for line in tell(profile, weak)]
    assert words == ["button a down", "button a up", "button a down", "button a up"]
    limited = make_profile("when: {gesture: pinch, release: {max_hold_ms: 300}}, do: {button: a}")
    assert tell(limited, long(1000)) == ["20 button a down", "320 button a up"]
    sudden = "pinch 5mm 0ms hold 500ms release 0ms; rest 50ms; pinch 5mm 0ms hold 100ms release 0ms"
    assert [line.split(" ", 1)[1] for line in tell(limited, sudden)] == [
        *("button a down", "button a up"),
        *("button a down", "button a up"),
    ]


@pytest.mark.parametrize(
    ("mode", "script", "expected"),
    [
        ("mode: toggle", f"{TAP}; rest 200ms; {TAP}", ["20 button a down", "340 button a up"]),
        ("mode: turbo, every_ms: 100, max_s: 0.5", long(800),
         ["20 button a down", "70 button a up", "120 button a down", "170 button a up",
          "220 button a down", "270 button a up", "320 button a down", "370 button a up",
          "420 button a down", "470 button a up"]),
        ("repeat: {delay_ms: 200, every_ms: 100}", long(300),
         ["20 button a down", "200 button a up", "220 button a down", "300 button a up",
          "320 button a down", "370 button a up"]),
    ],
)  # fmt: skip
def test_modes(mode: str, script: str, expected: list[str]) -> None:
    assert tell(make_profile(f"when: pinch, do: {{button: a, {mode}}}"), script) == expected


MODIFIED = (
    "when: pinch, do: {{key: shift, mode: {mode}}}",
    "when: zoom, do: {{key: a}}",
    "when: twist_cw, do: {{key: ctrl, mode: {mode}}}",
)


@pytest.mark.parametrize("mode", ["sticky", "oneshot"])
def test_a_modifier_is_kept_for_the_next_action(mode: str) -> None:
    profile = make_profile(*(line.format(mode=mode) for line in MODIFIED))
    mapping = Mapping(profile, RAW)
    held = [
        state.keys for state in run(mapping, f"{TAP}; twist_cw tap; zoom tap; rest 50ms; zoom tap")
    ]
    changes = [keys for before, keys in zip([None, *held], held, strict=False) if keys != before]
    shift, ctrl, a = "KEY_LEFTSHIFT", "KEY_LEFTCTRL", "KEY_A"
    assert changes == [
        frozenset(),
        {shift},
        {shift, ctrl},
        {shift, ctrl, a},
        {shift, ctrl},
        frozenset(),
        {a},
        frozenset(),
    ]


def test_twice_in_a_row_locks_a_sticky_key_and_a_third_time_frees_it() -> None:
    profile = make_profile(*(line.format(mode="sticky") for line in MODIFIED))
    mapping = Mapping(profile, RAW)
    run(mapping, f"{TAP}; rest 50ms; {TAP}; zoom tap")
    assert mapping.update(next(iter(rehearse("rest 10ms")))).keys == frozenset()  # a gap lets go
    states = run(mapping, f"{TAP}; rest 50ms; {TAP}; zoom tap; rest 50ms", 10_000)
    assert states[-1].keys == {"KEY_LEFTSHIFT"}
    states = run(mapping, f"{TAP}; rest 50ms", states[-1].t_us + 10_000)
    assert states[-1].keys == frozenset()


def test_sequences_act_on_their_last_gesture() -> None:
    when = "when: {sequence: [push_left, push_left, twist_cw], within_ms: 2000}"
    profile = make_profile(f"{when}, do: {{button: start}}")
    left, twist = "push left 5mm tap; rest 100ms", "twist_cw 5mm tap"

    def hear(script: str) -> list[str]:
        """What is told, without its time and the binding's name."""
        words = [line.split(" ", 1)[1] for line in tell(profile, script)]
        return [re.split(r"\(|, because ", word)[-1] for word in words]

    first, second, both = "1 of 3)", "2 of 3)", ["button start down", "button start up"]
    assert hear(f"{left}; {left}; {twist}") == [first, second, *both]
    assert hear(f"{left}; {left}; {left}; {twist}") == [first, second, second, *both]
    assert hear(f"{left}; {twist}; {left}") == [first, first]
    assert hear(f"{left}; push right 5mm tap; {left}; {twist}") == [first, first]
    *_, slow = hear(f"{left}; rest 2s; {left}; {twist}")
    assert slow.startswith("sequence took")


def test_presets_differ_as_in_the_table() -> None:
    profile = make_profile("when: pinch, do: {button: a}")
    begins = {}
    for preset in ("game", "steady", "slow"):
        user = UserSettings(filter="none", timing=preset)
        begins[preset] = tell(profile, long(1000), user)[0]
    assert begins == {
        "game": "20 button a down",
        "steady": "140 button a down",
        "slow": "1060 button a down",  # when it ends
    }


def test_the_slower_of_profile_and_user_holds() -> None:
    profile = make_profile("when: pinch, do: {button: a}", more="timing: {accept_ms: 300}")
    user = UserSettings(filter="none", timing="steady")
    assert tell(profile, long(1000), user)[0] == "320 button a down"
    profile = make_profile("when: pinch, do: {button: a}", more="timing: {accept_ms: 30}")
    assert tell(profile, long(1000), user)[0] == "140 button a down"


def test_no_binding_is_faster_than_the_person() -> None:
    profile = make_profile("when: {gesture: pinch, accept_ms: 30}, do: {button: a}")
    assert tell(profile, long(1000))[0] == "50 button a down"
    user = UserSettings(filter="none", timing="steady")
    assert tell(profile, long(1000), user)[0] == "140 button a down"
    profile = make_profile("when: {gesture: pinch, trigger: press}, do: {button: a}")
    user = UserSettings(filter="none", timing="slow")
    assert tell(profile, long(1000), user)[0] == "1060 button a down"


def test_without_a_weak_release_the_threshold_is_the_threshold() -> None:
    profile = make_profile("when: {gesture: pinch, on_mm: 10, off_mm: 9}, do: {button: a}")
    script = "pinch 11mm 50ms hold 100ms release 0ms; pinch 8.9mm 0ms hold 100ms release 0ms"
    again = "; pinch 10.1mm 0ms hold 100ms"
    words = [line.split(" ", 1)[1] for line in tell(profile, script + again)]
    assert words == ["button a down", "button a up"] * 2
