"""Two players at once, each with nodes of their own."""


def test_each_player_has_a_pad_of_their_own(guest):
    seen = guest("players")
    assert seen["nodes"] == ["neurotouch/keyboard1", "neurotouch/pad0", "neurotouch/pad1"]
    assert seen["games"] == {"sdl2": 2, "sdl3": 2}
    assert seen["keys"] == [[[1, 0x130, 1]], [[1, 0x131, 1]]]
