import numpy as np
import pytest

from neurotouch_hid.errors import SourceError
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.source.simulator import Simulator, find_scene, scene_config, scene_names


@pytest.mark.parametrize("name", scene_names())
def test_every_scene_starts_at_rest_and_never_overlaps(name):
    script = find_scene(name)
    assert script.name == name
    assert all(stroke.start_us >= 600_000 for stroke in script.strokes)
    for stroke, after in zip(script.strokes, script.strokes[1:], strict=False):
        assert stroke.end_us <= after.start_us
    assert not script.strokes or script.strokes[-1].end_us <= script.duration_us
    assert len(next(iter(Simulator(script, scene_config(name)))).events) > 0


def test_the_tour_shows_every_gesture_and_begins_again():
    script = find_scene("tour")
    assert {stroke.kind for stroke in script.strokes} == set(GestureKind) - {GestureKind.NONE}
    later, _ = script.find(script.duration_us + script.strokes[0].start_us)
    assert later is script.strokes[0]


def test_fast_is_as_fast_and_as_far_as_the_paper():
    simulator = Simulator(find_scene("fast"))
    first = find_scene("fast").strokes[0]
    times = range(first.start_us, first.start_us + 400_000, 4_000)
    size = np.array([simulator.truth(t).intensity_mm for t in times])
    assert size.max() == pytest.approx(18.0, abs=1.0)
    assert 170 < np.diff(size).max() / 0.004 < 230


def test_an_unknown_scene_says_what_may_have_been_meant():
    with pytest.raises(SourceError) as caught:
        find_scene("twist-clockwise")
    assert "sim:twist-c" in caught.value.hint
    with pytest.raises(SourceError) as caught:
        find_scene("zzz")
    assert "tour" in caught.value.hint
