"""A check that hangs, breaks or cannot be loaded is one finding, and the others are made."""

import threading

import pytest

from neurotouch_hid.doctor import Check, CheckStatus, examine, list_checks
from neurotouch_hid.doctor.finding import approve, skip
from neurotouch_hid.errors import DeviceError


def raise_(error):
    raise error


@pytest.mark.parametrize(
    ("look", "status", "words"),
    [
        (lambda: approve("Good."), CheckStatus.OK, "Good."),
        (lambda: skip("Not here."), CheckStatus.SKIPPED, "Not here."),
        (lambda: raise_(DeviceError("No pad.", hint="Make one.")), CheckStatus.FAILED, "No pad."),
        (lambda: raise_(OSError(5, "Input/output error", "/dev/x")), CheckStatus.FAILED, "/dev/x"),
        (lambda: raise_(ImportError("No module named 'evdev'")), CheckStatus.FAILED, "evdev"),
    ],
)
def test_what_a_check_may_do(look, status, words):
    (finding,) = examine([Check("it", look)])
    assert (finding.check, finding.status) == ("it", status)
    assert words in finding.sentence
    assert bool(finding.fix) == (status is CheckStatus.FAILED)


def test_a_check_that_hangs_is_left_alone():
    go_on = threading.Event()

    def hang():
        go_on.wait()
        return approve("At last.")

    findings = list(examine([Check("stuck", hang, 0.05), Check("next", lambda: approve("Good."))]))
    go_on.set()
    assert [finding.status for finding in findings] == [CheckStatus.FAILED, CheckStatus.OK]
    assert "no answer" in findings[0].sentence


def test_findings_come_one_by_one():
    looked = []

    def look(name):
        looked.append(name)
        return approve("")

    findings = examine([Check(n, lambda n=n: look(n)) for n in "abc"])
    assert next(findings).check == "a"
    assert looked == ["a"]


def test_every_row_has_a_name_of_its_own():
    names = [check.name for check in list_checks()]
    assert len(set(names)) == len(names) == 29


def test_a_check_that_takes_its_time_says_what_it_is_at(monkeypatch):
    monkeypatch.setattr("neurotouch_hid.doctor.examination.TELL_S", 0.01)
    monkeypatch.setattr("neurotouch_hid.doctor.examination.TELL_AGAIN_S", 0.01)
    told: list[str] = []
    done = threading.Event()

    def look():
        done.wait(60.0)
        return approve("Good.")

    def tell(text: str) -> None:
        told.append(text)
        if len(told) == 2:
            done.set()

    (finding,) = examine([Check("pipeline", look, 60.0)], tell=tell)
    assert finding.sentence == "Good."
    assert told[0].startswith("Checking: pipeline. 0 s of at most 60 s")
