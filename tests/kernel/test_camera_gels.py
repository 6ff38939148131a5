"""Two cameras, two drivers, two profiles: each gel moves its player's pad and no other."""

import pytest

A, B = 0x130, 0x131


@pytest.fixture(scope="module")
def seen(guest):
    return guest("gels")


def test_each_player_has_a_camera_a_profile_and_a_pad(seen):
    assert seen["names"] == ["Microsoft X-Box 360 pad", "NeuroTouch Gamepad"]
    assert seen["status"] == [
        {"profile": "one", "source": "davis:00000001"},
        {"profile": "two", "source": "davis:00000002"},
    ]
    assert seen["at_rest"] == [[], []]


def test_a_gel_moves_only_its_own_pad(seen):
    first, second = seen["first_presses"]
    assert first[0] == [A, 1]
    assert second == []
    before, after = seen["unplugged"], seen["second_presses"]
    assert {code for code, _ in before[0]} == {A}
    assert before[1] == []
    assert after[0] == before[0]
    assert after[1][0] == [B, 1]


def test_an_unplugged_gel_lets_go_and_leaves_the_other_alone(seen):
    assert seen["unplugged"][0][-1] == [A, 0]
    assert {code for code, _ in seen["at_the_end"][1]} == {B}
    assert seen["exit_codes"] == [0, 0]
    assert [keys[-1][1] for keys in seen["at_the_end"]] == [0, 0]
