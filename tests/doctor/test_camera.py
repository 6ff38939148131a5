"""A camera that may not be opened; the rest is tried in tests/cli/test_camera.py."""

from neurotouch_hid.doctor import camera
from neurotouch_hid.doctor.finding import CheckStatus
from neurotouch_hid.source.davis import CameraInfo

INFO = CameraInfo(2, 5, "2-1", "00000216", "DAVIS 346", 5000, 6, "no right to open it")


def test_without_right_the_rule_is_given():
    finding = camera._explain_right(INFO)
    assert finding.status is CheckStatus.FAILED
    assert "00000216 is present, but not readable" in finding.sentence
    assert any("70-neurotouch-camera.rules" in line for line in finding.commands)


def test_where_the_service_is_installed_it_is_started_instead(monkeypatch):
    monkeypatch.setattr(camera, "has_service", lambda: True)
    finding = camera._explain_right(INFO)
    assert finding.commands[0] == "sudo systemctl start neurotouch"


def test_a_camera_that_may_sleep(tmp_path):
    (tmp_path / "power").mkdir()
    for word, sleeps in (("on", False), ("auto", True)):
        (tmp_path / "power/control").write_text(f"{word}\n")
        assert camera._may_sleep(tmp_path) is sleeps
