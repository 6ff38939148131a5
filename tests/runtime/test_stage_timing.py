"""A stage's timer keeps all calls, however many there are."""

from time import perf_counter_ns

from neurotouch_hid.runtime.stage_timing import KEPT, StageTimer

SHORT_NS, LONG_NS = 1_000_000_000, 9_000_000_000  # beside these the test itself takes no time


def test_every_call_counts_and_the_newest_are_kept_one_by_one():
    timer = StageTimer()
    for took_ns in [SHORT_NS] * (3 * KEPT) + [LONG_NS] * KEPT:
        begun_ns = perf_counter_ns()
        assert timer.end(begun_ns - took_ns) >= begun_ns
    spent_ns = 3 * KEPT * SHORT_NS + KEPT * LONG_NS
    assert spent_ns <= timer.spent_ns < 1.2 * spent_ns
    assert len(timer.recent_ns) == KEPT
    assert min(timer.recent_ns) >= LONG_NS
    short_ns, long_ns = timer.percentiles_ns((75.0, 76.0))
    assert SHORT_NS <= short_ns < 2 * SHORT_NS
    assert LONG_NS <= long_ns < 2 * LONG_NS
