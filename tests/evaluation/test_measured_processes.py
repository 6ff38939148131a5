"""The processes that a benchmark starts end with it."""

import pytest

from neurotouch_hid.evaluation.speed import benchmark


def test_a_process_does_not_outlast_an_interrupt(monkeypatch):
    def wait(words, process):
        wait_for(words, process)
        started.append(process)
        raise KeyboardInterrupt

    started, wait_for = [], benchmark._wait_for
    monkeypatch.setattr(benchmark, "_wait_for", wait)
    with pytest.raises(KeyboardInterrupt):
        benchmark._measure_start("neurotouch")
    (process,) = started
    assert process.returncode == -9


def test_a_process_that_nobody_ends_ends_by_itself(monkeypatch):
    monkeypatch.setattr(benchmark, "_MOST_S", "1")
    with benchmark._run("sim:rest", "neurotouch") as process:
        benchmark._reap(process)
    assert process.returncode == 0
