"""Folders of their own for the drivers of this folder."""

import pytest


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for name in ("XDG_RUNTIME_DIR", "XDG_CONFIG_HOME"):
        (tmp_path / name.lower()).mkdir(mode=0o700)
        monkeypatch.setenv(name, str(tmp_path / name.lower()))
    monkeypatch.delenv("RUNTIME_DIRECTORY")
    return tmp_path
