"""A machine that is busy with other tests answers late."""

import pytest


@pytest.fixture(autouse=True)
def patience(monkeypatch):
    monkeypatch.setattr("neurotouch_hid.desktop.compositor._PATIENCE_S", 60.0)
    monkeypatch.setattr("neurotouch_hid.desktop.wayland.PATIENCE_S", 60.0)
