"""Chords on a keyboard that a real kernel made."""


def test_chords_are_heard_on_a_real_keyboard_and_never_on_our_own(guest):
    seen = guest("chords")
    assert "Real keyboard" in seen["found"]
    assert not any("NeuroTouch" in name for name in seen["found"])
    assert "NeuroTouch" not in seen["before"]
    assert seen["on_ours"] == []
    assert seen["heard"] == ["pause", "panic"]
