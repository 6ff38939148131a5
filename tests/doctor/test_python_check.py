"""What the doctor says about Python and the libraries."""

import importlib.metadata

import pytest

from neurotouch_hid.doctor.finding import CheckStatus
from neurotouch_hid.doctor.machine import check_python


@pytest.mark.parametrize(
    "requirement",
    [
        "nowhere>=2; platform_machine == 'another'",
        "nowhere>=2; python_version < '3.0'",
        "nowhere>=2; extra == 'gel'",
    ],
)
def test_what_this_machine_does_not_need_is_not_missing(monkeypatch, requirement):
    monkeypatch.setattr(importlib.metadata, "requires", lambda _: [requirement])
    assert check_python().status is CheckStatus.OK


def test_what_is_not_installed_is_named(monkeypatch):
    needed = ["nowhere>=2; sys_platform != 'another'"]
    monkeypatch.setattr(importlib.metadata, "requires", lambda _: needed)
    found = check_python()
    assert found.status is CheckStatus.FAILED
    assert "nowhere" in found.sentence
