"""``doctor``, ``devices``, ``diagnostics`` and ``neurotouch`` alone, as a user types them."""

import json
import subprocess

import pytest

from neurotouch_hid.cli.doctor import _write_script
from neurotouch_hid.doctor import CheckStatus, Finding, list_checks
from tests.processes import make_environment, run_command, run_neurotouch

STATUS = ("OK", "WARNING", "FAILED", "SKIPPED")


@pytest.fixture(scope="module")
def call(tmp_path_factory):
    folder = tmp_path_factory.mktemp("person")
    environment = make_environment(folder) | {"XDG_CACHE_HOME": str(folder / "cache")}

    def call(*arguments):
        return run_neurotouch(*arguments, code=None, env=environment, stdin=subprocess.DEVNULL)

    return call


def test_every_check_is_a_line_that_begins_with_its_status(call):
    done = call("doctor", "--directions")
    assert "Traceback" not in done.stderr
    checks = [check.name for check in list_checks()]
    lines = [line for line in done.stdout.splitlines() if line.startswith(STATUS)]
    assert [line[9:].split(":")[0] for line in lines] == [*checks, "directions"]
    assert lines[-1].startswith("SKIPPED")  # no terminal, so nobody can press anything
    assert done.returncode == any(line.startswith("FAILED") for line in lines)
    assert "\x1b" not in done.stdout


def test_the_stop_keys_are_tried_without_the_checks(call):
    done = call("doctor", "--keys")
    (line,) = done.stdout.splitlines()
    assert line.startswith("SKIPPED  stop keys: ")  # no terminal, so nobody can press anything
    assert done.returncode == 0


def test_json_says_the_same_to_programs(call):
    done = call("doctor", "--json")
    findings = json.loads(done.stdout)
    assert [finding["check"] for finding in findings] == [check.name for check in list_checks()]
    assert {finding["status"] for finding in findings} <= set(STATUS)
    assert all(finding["sentence"] for finding in findings)
    for finding in findings:
        if finding["status"] in ("FAILED", "WARNING"):
            assert finding["fix"]
    assert done.returncode == any(finding["status"] == "FAILED" for finding in findings)
    script = _write_script([Finding(**finding) for finding in findings])
    assert "Read it before you run" in script
    subprocess.run(["sh", "-nc", script], check=True)


def test_the_script_does_what_the_findings_say_and_nothing_twice(tmp_path):
    marks = [f'echo "it\'s {n}" >> {tmp_path}/done' for n in range(3)]
    findings = [
        Finding(
            CheckStatus.FAILED, "Broken.", "Mend it.\nThis way.", (marks[0], marks[1]), check="a"
        ),
        Finding(CheckStatus.OK, "Good.", check="b"),
        Finding(CheckStatus.WARNING, "So so.", "Mend it too.", (marks[1], marks[2]), check="c"),
    ]
    script = _write_script(findings)
    assert script.startswith("#!/bin/sh\n")
    assert "# FAILED a: Broken.\n# Mend it.\n# This way.\n" in script
    assert "sudo" not in script
    done = run_command("sh", "-c", script)
    assert (tmp_path / "done").read_text() == "it's 0\nit's 1\nit's 2\n"
    assert done.stdout.splitlines() == [f"+ {mark}" for mark in marks]


def test_what_a_device_calls_itself_stays_a_comment():
    nasty = "A keyboard\nrm -rf /\r\nrm\x0brm\x85rm"
    script = _write_script([Finding(CheckStatus.FAILED, nasty, nasty, ("true",), check="a")])
    code = [line for line in script.split("\n") if line and not line.startswith("#")]
    assert code == ["set -eu", "echo '+ true'", "true"]


def test_a_script_without_anything_to_do_says_so():
    script = _write_script([Finding(CheckStatus.OK, "Good.", check="b")])
    assert "Nothing that a command could fix" in script
    subprocess.run(["sh", "-nc", script], check=True)


def test_devices(call):
    done = call("devices", "--json")
    assert done.returncode == 0
    said = json.loads(done.stdout)
    assert set(said) == {"cameras", "video_cameras", "event_cameras", "pads"}
    plain = call("devices").stdout
    if not said["cameras"] and not said["video_cameras"]:
        assert "No camera is plugged in. Try without: neurotouch demo" in plain
    if not said["pads"]:
        assert "There is no game controller." in plain


def test_diagnostics_to_a_file(call, tmp_path):
    report = tmp_path / "report.json"
    done = call("diagnostics", "--json", "--out", report)
    assert done.returncode == 0, done.stderr
    said = json.loads(report.read_text())
    assert [each["check"] for each in said["doctor"]] == [check.name for check in list_checks()]
    assert said["left_out"]
    done = call("diagnostics", "--out", report)
    assert done.returncode == 1
    assert "--force" in done.stderr


def test_alone_it_says_the_next_step(call):
    done = call()
    assert done.returncode == 0
    assert done.stdout.splitlines()[-1] == "All commands: neurotouch --help"
    if not json.loads(call("devices", "--json").stdout)["cameras"]:
        assert done.stdout.startswith("No camera found. Try it now: neurotouch demo\n")
