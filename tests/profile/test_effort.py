"""Fading peaks and long holds."""

from neurotouch_hid.profile import Mapping, UserSettings
from tests.profile.stage import make_profile, run

PROFILE = make_profile("when: zoom, do: {trigger: right}", "when: push, do: {stick: left}")


def use(mapping: Mapping, times: int, mm: float, start_us: int) -> int:
    states = run(mapping, f"zoom {mm}mm tap; rest 100ms;" * times, start_us)
    return states[-1].t_us + 10_000


def test_a_movement_that_fades_by_a_fifth_gets_a_smaller_range_suggested() -> None:
    user = UserSettings.model_validate({"filter": "none", "range": {"zoom": {"full": 4.5}}})
    mapping = Mapping(PROFILE, user)
    t_us = use(mapping, 60, 5.0, 0)
    (zoom,) = mapping.usages()
    assert (zoom.movement, zoom.uses, zoom.full_mm) == ("zoom", 60, None)
    t_us = use(mapping, 50, 3.5, t_us)
    (zoom,) = mapping.usages()
    assert zoom.full_mm == 3.5
    use(mapping, 50, 2.6, t_us)
    (zoom,) = mapping.usages()
    assert zoom.full_mm == round(0.6 * 4.5, 1), "not below 60 %"


def test_a_hand_that_begins_tired_is_measured_against_its_calibration() -> None:
    user = UserSettings.model_validate({"filter": "none", "range": {"zoom": {"full": 4.5}}})
    mapping = Mapping(PROFILE, user)
    t_us = use(mapping, 49, 3.4, 0)
    assert mapping.usages()[0].full_mm is None, "not enough uses yet"
    use(mapping, 1, 3.4, t_us)
    assert mapping.usages()[0].full_mm == 3.4


def test_who_was_never_calibrated_is_measured_against_the_first_uses() -> None:
    mapping = Mapping(PROFILE, UserSettings(filter="none"))
    t_us = use(mapping, 50, 5.0, 0)
    use(mapping, 50, 3.5, t_us)
    assert mapping.usages()[0].full_mm == round(0.7 * 4.5, 1)


def test_partial_movements_are_no_fatigue() -> None:
    mapping = Mapping(PROFILE, UserSettings(filter="none"))
    use(mapping, 120, 3.0, 0)
    (zoom,) = mapping.usages()
    assert zoom.full_mm is None


def test_long_holds_are_counted_by_movement() -> None:
    mapping = Mapping(PROFILE, UserSettings(filter="none"))
    run(mapping, "push left 5mm hold 6s; push left 5mm hold 3s; push up 5mm hold 6s; zoom 5mm tap")
    holds = {usage.movement: usage.long_holds for usage in mapping.usages()}
    assert holds == {"push_left": 1, "push_up": 1, "zoom": 0}
