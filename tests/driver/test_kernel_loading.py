"""A second process compiles a part, where there can be one."""

from contextlib import contextmanager

import pytest

from neurotouch_hid.driver import DriverOptions, kernel_loading
from neurotouch_hid.driver.kernel_loading import share_compiling
from neurotouch_hid.geometry import PAPER_GEL


@pytest.fixture
def submitted(monkeypatch):
    """What the second process is asked to do, on a machine with two processors."""
    asked = []

    class Pool:
        def submit(self, task, *args):
            asked.append((task, *args))

    @contextmanager
    def open_one(jobs):
        assert jobs == 1
        yield Pool()

    monkeypatch.setattr(kernel_loading, "open_pool", open_one)
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    monkeypatch.delenv("NUMBA_CPU_NAME", raising=False)
    return asked


def share(source="sim:tour"):
    options = DriverOptions(source=source)
    with share_compiling(options, PAPER_GEL):
        pass
    return options


@pytest.mark.parametrize("source", ["sim:tour", "davis:"])
def test_it_recognises_a_push_and_plays_the_simulator(submitted, monkeypatch, source):
    options = share(source)
    ((task, *args),) = submitted
    assert args == [options, PAPER_GEL]
    done = []
    monkeypatch.setattr(kernel_loading, "warm_up_gestures", lambda *_: done.append("gestures"))
    monkeypatch.setattr(
        kernel_loading, "open_source", lambda *_, **__: done.append("source") or 1 / 0
    )
    if source == "davis:":
        task(*args)
        assert done == ["gestures"]
    else:
        with pytest.raises(ZeroDivisionError):
            task(*args)
        assert done == ["gestures", "source"]


def test_code_for_another_processor_is_made_by_one_process(submitted, monkeypatch):
    monkeypatch.setenv("NUMBA_CPU_NAME", "x86-64-v3")
    share()
    assert submitted == []


def test_one_processor_is_not_shared(submitted, monkeypatch):
    monkeypatch.setattr("os.cpu_count", lambda: 1)
    share()
    assert submitted == []


def test_a_machine_without_shared_memory_compiles_alone(submitted, monkeypatch):
    def fail(_):
        raise OSError("no shared memory")

    monkeypatch.setattr(kernel_loading, "open_pool", fail)
    share()
    assert submitted == []


def test_what_goes_wrong_meanwhile_is_not_hidden(submitted):
    with pytest.raises(OSError, match="disk"), share_compiling(DriverOptions(), PAPER_GEL):
        raise OSError("disk")
