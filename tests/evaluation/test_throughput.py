"""The figures of ISO 9241-411 against values worked out by hand."""

import json
import math

import pytest

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.evaluation.people.throughput import (
    Trial,
    compare_results,
    measure_block,
    measure_pointing,
    read_result,
)


def make_trial(
    overshoot: float, aside: float = 0.0, took: float = 1.0, width: float = 40.0
) -> Trial:
    """A movement straight down, 300 px."""
    return Trial(width, (0.0, 0.0), (0.0, 300.0), (aside, 300.0 + overshoot), took)


def test_effective_width_distance_and_throughput() -> None:
    block = measure_block(
        [make_trial(-10.0), make_trial(0.0, took=2.0), make_trial(10.0, took=3.0)]
    )
    assert block.effective_width_px == pytest.approx(41.33), "SDx = 10 with n - 1"
    assert block.effective_distance_px == pytest.approx(300.0)
    assert block.movement_s == pytest.approx(2.0)
    assert block.throughput_bit_s == pytest.approx(math.log2(300.0 / 41.33 + 1.0) / 2.0)


def test_only_what_lies_along_the_way_counts_for_the_width() -> None:
    block = measure_block([make_trial(0.0, aside) for aside in (-15.0, 0.0, 30.0)])
    assert block.effective_width_px == 1.0, "the pointer's resolution"
    assert block.error_rate == pytest.approx(1 / 3), "30 px aside are outside a target 40 wide"


def test_stopping_short_moves_the_effective_distance() -> None:
    block = measure_block([make_trial(shift) for shift in (-40.0, -30.0, -20.0)])
    assert block.effective_distance_px == pytest.approx(270.0)
    assert block.error_rate == pytest.approx(2 / 3)


def test_the_whole_is_the_mean_of_the_blocks_whatever_their_size() -> None:
    wide = [make_trial(shift, width=80.0) for shift in (-20.0, 0.0, 20.0)]
    narrow = [make_trial(shift, took=2.0) for shift in (-5.0, 0.0, 5.0, -5.0, 5.0, 0.0)]
    result = measure_pointing([*wide, *narrow])
    each = [measure_block(wide).throughput_bit_s, measure_block(narrow).throughput_bit_s]
    assert result["throughput_bit_s"] == pytest.approx(sum(each) / 2)
    assert (result["trials"], result["movement_s"]) == (9, 1.5)
    assert json.loads(json.dumps(result)) == result


def test_too_few_selections_are_refused() -> None:
    with pytest.raises(NeuroTouchError, match="2 selections"):
        measure_pointing([make_trial(0.0), make_trial(1.0)])


def test_before_and_after() -> None:
    before = {"throughput_bit_s": 2.0, "movement_s": 1.0, "error_rate": 0.0}
    after = {"throughput_bit_s": 3.0, "movement_s": 1.2, "error_rate": 0.0}
    assert compare_results(before, after) == [
        "throughput: before 2.00 bit/s, now 3.00 bit/s, +50 %, better",
        "movement time: before 1.00 s, now 1.20 s, +20 %, worse",
        "missed targets: before 0.00, now 0.00, the same",
    ]


@pytest.mark.parametrize("content", [None, "{", "[]", "{}", '{"throughput_bit_s": "fast"}'])
def test_another_file_is_no_result(content, tmp_path) -> None:
    path = tmp_path / "before.json"
    if content is not None:
        path.write_text(content)
    with pytest.raises(NeuroTouchError, match=r"before\.json") as caught:
        read_result(path)
    assert "--json" in caught.value.hint
