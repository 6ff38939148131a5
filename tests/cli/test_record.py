"""``neurotouch record`` as a user meets it, in a process of its own."""

import json
import os
import pty
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import asdict

import pytest

from neurotouch_hid.cli.record import _read_rig
from neurotouch_hid.driver.control_socket import ControlSocket
from neurotouch_hid.recording import Clip, Recording, RecordingWriter, gel_path
from neurotouch_hid.recording.wire import send_packet
from neurotouch_hid.source.rig_file import load_rig_file
from neurotouch_hid.source.slice_pacer import LONGEST_US
from tests.processes import (
    LIMIT_S,
    PROGRAM,
    Process,
    make_environment,
    run_command,
    run_neurotouch,
    start_neurotouch,
)
from tests.recording.clips import draw, write_clip
from tests.recording.streams import make_packets
from tests.recording.test_writer import count, count_with_the_maker
from tests.waiting import wait_until


@pytest.fixture
def environment(tmp_path):
    return make_environment(tmp_path)


@pytest.fixture
def record(environment):
    def call(*arguments, **settings):
        return run_neurotouch("record", *arguments, code=None, env=environment, **settings)

    return call


@pytest.fixture
def quick(tmp_path):
    """A source that opens at once, and gives 20 000 events and 5 frames in 0.2 s."""
    path = tmp_path / "source.aedat4"
    with RecordingWriter(path) as writer:
        for packet in make_packets():
            writer.write(packet)
    return "--source", f"file:{path}"


@pytest.fixture
def endless(tmp_path, environment):
    """A recording that goes on until somebody ends it, at the speed of a camera."""
    path = tmp_path / "endless.aedat4"
    process = start_neurotouch("record", path, "--source", "sim:tour", env=environment)
    wait_for_size(path, 300_000, process)
    yield path, process
    process.kill()
    process.communicate()


def test_it_says_what_is_in_the_file(tmp_path, record, quick):
    done = record(tmp_path / "a.aedat4", *quick)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"OK {tmp_path / 'a.aedat4'} has 0.2 s of file:")
    assert "20,000 events, 5 frames" in done.stdout
    assert count(tmp_path / "a.aedat4") == (20_000, 5)


def test_a_recording_whose_gel_file_cannot_be_written_is_told_of(tmp_path, record, quick):
    path = tmp_path / f"{'n' * 248}.aedat4"  # one letter more, and NAME.gel.yaml is too long
    done = record(path, *quick)
    assert done.returncode == 4
    assert done.stdout.startswith(f"WARNING {path} has 0.2 s of file:")
    assert ".gel.yaml' cannot be written: File name too long." in done.stderr


def test_the_simulator_for_so_many_seconds(tmp_path, record):
    done = record(tmp_path / "a.aedat4", "--source", "sim:push", "--seconds", "1", "--json")
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert said["status"] == "OK"
    assert said["seconds"] == pytest.approx(1.0)
    assert said["lost_before"] == said["lost_here"] == 0
    assert count(tmp_path / "a.aedat4") == (said["events"], said["frames"])
    assert said["frames"] == 25
    assert said["size_bytes"] == (tmp_path / "a.aedat4").stat().st_size


def test_what_is_there_is_not_replaced_unless_asked_to(tmp_path, record, quick):
    path = tmp_path / "a.aedat4"
    path.write_bytes(b"precious")
    done = record(path, *quick)
    assert done.returncode == 4
    assert "--force" in done.stderr
    # A source that cannot be opened costs no older file either.
    assert record(path, "--source", "sim:tuor", "--force").returncode == 3
    assert path.read_bytes() == b"precious"
    assert record(path, *quick, "--force").returncode == 0
    assert count(path) == (20_000, 5)


@pytest.mark.parametrize("ending", ["labels.csv", "rig.yaml"])
def test_a_recording_that_a_person_has_worked_on_is_not_replaced(tmp_path, record, quick, ending):
    path, made = tmp_path / "a.aedat4", tmp_path / f"a.{ending}"
    path.write_bytes(b"precious")
    made.write_text("hours of work")
    done = record(path, *quick, "--force")
    assert done.returncode == 4
    assert f"Error: '{made}' belongs to an older recording.\n" in done.stderr
    assert (path.read_bytes(), made.read_text()) == (b"precious", "hours of work")
    made.rename(tmp_path / "elsewhere")
    assert record(path, *quick, "--force").returncode == 0


@pytest.mark.parametrize("ending", ["labels.csv", "rig.yaml", "gel.yaml"])
def test_files_of_a_recording_that_has_gone_do_not_pass_to_a_new_one(
    tmp_path, record, quick, ending
):
    path, made = tmp_path / "a.aedat4", tmp_path / f"a.{ending}"
    made.write_text("hours of work")
    done = record(path, *quick)
    assert done.returncode == 4
    assert f"Error: '{made}' belongs to an older recording.\n" in done.stderr
    assert made.read_text() == "hours of work"
    assert not path.exists()


@pytest.mark.parametrize("name", ["a.mp4", "-", "a"])
def test_another_kind_of_file_is_refused(tmp_path, record, quick, name):
    done = record(name, *quick, cwd=tmp_path)
    assert done.returncode == 4
    assert "ends in .aedat4" in done.stderr
    assert not (tmp_path / name).exists()


def test_an_empty_name_is_called_empty(tmp_path, record, quick):
    done = record("", *quick, cwd=tmp_path)
    assert done.returncode == 4
    assert "Error: The name of the file is empty.\n" in done.stderr


def test_a_recording_is_not_recorded_to_itself(tmp_path, record, quick):
    path = tmp_path / "source.aedat4"
    for source in (f"file:{path}", str(path)):
        done = record(path, "--source", source, "--force")
        assert done.returncode == 4
        assert "is source and output at once" in done.stderr
    assert count(path) == (20_000, 5)


def test_neither_driver_nor_camera(tmp_path, record):
    done = record(tmp_path / "a.aedat4")
    assert done.returncode == 3
    assert "No DAVIS camera" in done.stderr
    assert not (tmp_path / "a.aedat4").exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("n_times", [1, 2])
def test_a_signal_is_the_normal_end(endless, number, n_times):
    path, process = endless
    for _ in range(n_times):
        process.send_signal(number)
    said, errors = process.communicate(timeout=LIMIT_S)
    # A second one may come when all is written and said, and then ends what is left: by design.
    assert process.returncode in ((0,) if n_times == 1 else (0, -number))
    assert said.startswith("OK ")
    assert "Traceback" not in errors
    assert count(path) == count_with_the_maker(path)
    assert count(path)[0] > 0


def test_killed_it_leaves_what_was_written(endless):
    path, process = endless
    process.kill()
    process.communicate(timeout=LIMIT_S)
    size = path.stat().st_size
    events, frames = 0, 0
    for batch, pictures in Recording(path):
        events, frames = events + len(batch), frames + len(pictures)
    assert size >= 300_000
    assert events > 1_000
    assert frames > 1


def test_a_full_disk_leaves_a_readable_file_and_says_why(tmp_path, record):
    """The kernel refuses to write on, in the middle of a packet."""
    path = tmp_path / "a.aedat4"
    arguments = (path, "--source", "sim:tour", "--seconds", "30")
    limit = {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (700_001, 700_001))}
    done = record(*arguments, **limit)
    assert done.returncode == 4
    assert done.stdout.startswith("WARNING ")
    assert "cannot be written: File too large" in done.stderr
    assert "Traceback" not in done.stderr
    assert path.stat().st_size <= 700_001
    assert count(path) == count_with_the_maker(path)


def test_a_full_disk_in_json(tmp_path, record, quick):
    path = tmp_path / "a.aedat4"
    limit = {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100_001, 100_001))}
    arguments = (path, *quick)
    done = record(*arguments, "--json", **limit)
    assert done.returncode == 4
    said = json.loads(done.stdout)
    assert said["status"] == "FAILED"
    assert "File too large" in said["error"]
    assert said["fix"]
    assert said["events"] <= count(path)[0]


def test_a_small_disk(tmp_path, record):
    """A file system of 70 MB: 64 of them are left to others."""
    folder = tmp_path / "disk"
    folder.mkdir()
    inside = f"mount -t tmpfs -o size=70m none {folder} && df --output=avail -B1 {folder}"
    alone = ["unshare", "--map-root-user", "--mount", "sh", "-c"]
    if (
        not shutil.which("unshare")
        or subprocess.run([*alone, inside], check=False, capture_output=True).returncode
    ):
        pytest.skip("no file system can be mounted here")
    arguments = f"record {folder}/a.aedat4 --source sim:tour --seconds 60"
    script = (
        f"mount -t tmpfs -o size=70m none {folder} || exit 99\n"
        f"{sys.executable} -m neurotouch_hid {arguments}\n"
        f"code=$?; cp {folder}/a.aedat4 {tmp_path}/kept.aedat4; exit $code"
    )
    done = run_command(*alone, script, code=4)
    assert "the disk is full" in done.stderr
    kept = tmp_path / "kept.aedat4"
    assert 4_000_000 < kept.stat().st_size < 7_000_000
    assert count(kept) == count_with_the_maker(kept)


@contextmanager
def driving(folder, *words):
    """A driver that plays, and the environment in which it is found."""
    options = ("--source", "sim:tour", "--seed", "5", "--device", "memory", "--show", "nothing")
    driver = Process(folder, "run", *options, *words, ready="Gamepad ready")
    try:
        yield driver.process, driver.environment
    finally:
        driver.end()


@pytest.fixture(scope="module")
def driver(tmp_path_factory):
    with driving(tmp_path_factory.mktemp("driver")) as driver:
        yield driver


def ask(environment):
    done = run_neurotouch("status", "--json", env=environment)
    return json.loads(done.stdout)


def test_while_playing_it_records_what_the_driver_sees(tmp_path, driver):
    process, environment = driver
    before = ask(environment)
    done = run_neurotouch(
        "record", tmp_path / "a.aedat4", "--seconds", "2", "--json", env=environment
    )
    said = json.loads(done.stdout)
    after = ask(environment)
    assert said["source"] == "sim:tour, from the running driver"
    assert (said["simulation"]["source"], said["simulation"]["seed"]) == ("sim:tour", 5)
    assert 2.0 <= said["seconds"] < 2.0 + LONGEST_US / 1e6  # the last slice is recorded whole
    assert count(tmp_path / "a.aedat4") == (said["events"], said["frames"])
    assert said["frames"] >= 49
    assert after["pid"] == before["pid"]
    assert after["state"] == "running"
    wait_until(lambda: ask(environment)["slices"] >= before["slices"] + 200)
    assert process.poll() is None


HEX = "version: 1\r\nname: six\r\nlayout: {kind: hex, pitch_mm: 4.65, radius_mm: 30}\r\n"
GRID = "version: 1\nname: mine\nlayout: {kind: grid, columns: 10, rows: 7, pitch_mm: 4}\n"


def test_the_gel_beside_a_recording_is_the_one_that_the_driver_plays(tmp_path):
    played, own = tmp_path / "other.gel.yaml", tmp_path / "config/neurotouch/gel.yaml"
    own.parent.mkdir(parents=True)
    own.write_text(GRID)
    played.write_bytes(HEX.encode())
    with driving(tmp_path, "--gel", str(played)) as (_, environment):
        played.write_text(GRID)  # it is too late to change the driver's gel
        out = tmp_path / "a.aedat4"
        words = ("record", out, "--seconds", "0.5")
        run_neurotouch(*words, env=environment)
        assert gel_path(out).read_bytes() == HEX.encode()
        refused = run_neurotouch(*words, "--force", "--gel", own, code=6, env=environment)
        assert "Leave --gel out." in refused.stderr
        assert gel_path(out).read_bytes() == HEX.encode()


def test_a_recording_of_the_usual_gel_has_no_file_of_the_persons_own(tmp_path, driver):
    environment = driver[1]
    own = tmp_path / "config/neurotouch/gel.yaml"
    own.parent.mkdir(parents=True)
    own.write_text(GRID)
    out = tmp_path / "a.aedat4"
    run_neurotouch(
        "record",
        out,
        "--seconds",
        "0.5",
        env={**environment, "XDG_CONFIG_HOME": str(tmp_path / "config")},
    )
    assert not gel_path(out).exists()


def test_a_source_that_falls_silent_does_not_outlast_its_seconds(tmp_path, driver):
    playing, environment = driver
    path = tmp_path / "a.aedat4"
    process = start_neurotouch("record", path, "--seconds", "6", "--json", env=environment)
    wait_for_size(path, 50_000, process)
    playing.send_signal(signal.SIGSTOP)
    try:
        said, errors = process.communicate(timeout=LIMIT_S)
    finally:
        playing.send_signal(signal.SIGCONT)
    assert process.returncode == 3, errors
    told = json.loads(said)
    assert told["status"] == "FAILED"
    assert told["error"].startswith("The source has been silent for 10 s")
    assert told["seconds"] < 6.0
    assert count(path)[0] == told["events"] > 0


@pytest.fixture
def standing_in(tmp_path):
    """Stands in for a driver: sends the packets of 0.2 s and may wait in their middle."""

    def serve(wait_s: float = 0.0) -> None:
        def feed(line):
            line.settimeout(LIMIT_S)
            for i, packet in enumerate(make_packets()):
                if i == 5:
                    time.sleep(wait_s)
                send_packet(line, packet)

        answer = {"ok": True, "source": "camera", "file": ""}
        control.serve(lambda _question, _uid: answer, {"record": feed})

    with ControlSocket(tmp_path / "run") as control:
        yield serve


def test_after_a_stall_it_goes_on_until_the_seconds_are_there(tmp_path, record, standing_in):
    standing_in(wait_s=4.0)
    done = record(tmp_path / "a.aedat4", "--seconds", "0.2", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["seconds"] == pytest.approx(0.2)
    assert count(tmp_path / "a.aedat4") == (20_000, 5)


def test_a_driver_that_ends_before_the_seconds_are_there_is_told_of(tmp_path, record, standing_in):
    standing_in()
    done = record(tmp_path / "a.aedat4", "--seconds", "5")
    assert done.returncode == 3
    assert done.stdout.startswith(
        f"WARNING {tmp_path / 'a.aedat4'} has 0.2 s of camera, from the running driver"
    )
    assert "Error: The source ended before 5 s were recorded." in done.stderr
    assert count(tmp_path / "a.aedat4") == (20_000, 5)


def test_on_a_terminal_progress_stays_in_one_line(tmp_path, environment):
    terminal, inside = pty.openpty()
    process = subprocess.Popen(
        [*PROGRAM, "record", str(tmp_path / "a.aedat4"), "--source", "sim:tour"],
        stdout=inside,
        stderr=inside,
        env=environment,
    )
    os.close(inside)
    shown = b""
    while shown.count(b"GB free") < 2:
        shown += os.read(terminal, 4096)
    process.send_signal(signal.SIGINT)
    assert process.wait(LIMIT_S) == 0
    os.close(terminal)
    assert re.search(
        rb"\r\x1b\[K\d+ s, [\d,]+ events/s, \d+ frames/s, 0 events lost, \d+ MB, [\d.,]+ GB free",
        shown,
    )
    assert shown.count(b"\n") == 1


def wait_for_size(path, size, process):
    deadline = time.monotonic() + LIMIT_S
    while not path.exists() or path.stat().st_size < size:
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_it_ends_with_the_driver(tmp_path):
    path = tmp_path / "a.aedat4"
    with driving(tmp_path) as (_, environment):
        process = start_neurotouch("record", path, env=environment)
        wait_for_size(path, 100_000, process)
    said, _ = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0
    assert said.startswith("OK ")
    assert count(path) == count_with_the_maker(path)


def test_a_recording_of_the_simulator_says_so(record, tmp_path):
    path = tmp_path / "folder" / "a.aedat4"
    path.parent.mkdir()
    words = (path, "--source", "sim:tour", "--seconds", "0.2", "--seed", "7")
    done = record(*words, "--json")
    assert "Recording SIMULATED sim:tour" in done.stderr
    mark = Recording(path).simulation
    assert mark is not None
    assert (mark.source, mark.seed) == ("sim:tour", 7)
    assert (
        mark.command == "neurotouch record a.aedat4 --source sim:tour --seconds 0.2 --seed 7 --json"
    )
    answer = json.loads(done.stdout)
    assert answer["simulation"] == asdict(mark)
    assert "of SIMULATED sim:tour" in answer["message"]
    again = tmp_path / "b.aedat4"
    done = record(again, "--source", f"file:{path}")
    assert Recording(again).simulation == mark
    assert "SIMULATED" in done.stdout


def test_a_recording_of_a_sensor_says_nothing(record, quick, tmp_path):
    done = record(tmp_path / "a.aedat4", *quick)
    assert "SIMULATED" not in done.stdout + done.stderr
    assert Recording(tmp_path / "a.aedat4").simulation is None


def test_a_clip_is_recorded_as_it_is(record, tmp_path):
    pictures = [draw(k) for k in range(20)]
    stamps = [0, *(k * 8_000 + 123 for k in range(1, 20))]
    source = write_clip(tmp_path / "a.mp4", pictures, stamps)
    (tmp_path / "a.rig.yaml").write_text("mirrored: true\n")
    done = record(tmp_path / "b.mkv", "--source", f"file:{source}", "--json")
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert (report["frames"], report["events"], report["lost_here"]) == (20, 0, 0)
    before, after = list(Clip(source)), list(Clip(tmp_path / "b.mkv"))
    assert [p.exposure_end_us for p in after] == stamps
    assert [p.jpeg for p in after] == [p.jpeg for p in before]
    assert (tmp_path / "b.rig.yaml").read_text() == "mirrored: true\n"
    (tmp_path / "a.rig.yaml").unlink()  # the next clip of this name is not mirrored
    again = record(tmp_path / "b.mkv", "--source", f"file:{source}", "--force")
    assert again.returncode == 0, again.stderr
    assert not (tmp_path / "b.rig.yaml").exists()


def test_a_clip_is_recorded_in_part(record, tmp_path):
    pictures = [draw(k) for k in range(20)]
    source = write_clip(tmp_path / "a.mkv", pictures, range(0, 800_000, 40_000), "ffv1", "gray")
    done = record(tmp_path / "b.mkv", "--source", source, "--seconds", "0.4")
    assert done.returncode == 0, done.stderr
    read = list(Clip(tmp_path / "b.mkv"))
    assert len(read) == 11
    assert (read[7].pixels == pictures[7]).all()


@pytest.mark.parametrize(
    ("out", "source", "words"),
    [
        ("b.aedat4", "a.mkv", "A recording in .aedat4 needs events"),
        ("b.avi", "a.mkv", "does not end in .aedat4 or .mkv"),
        ("b.mkv", "sim:push", "cannot keep events"),
    ],
)
def test_what_does_not_go_together_is_refused(record, tmp_path, out, source, words):
    write_clip(tmp_path / "a.mkv", [draw(0)], [0], "ffv1", "gray")
    name = source if ":" in source else tmp_path / source
    done = record(tmp_path / out, "--source", name, "--seconds", "1")
    assert done.returncode == 4
    assert words in done.stderr
    assert not (tmp_path / out).exists()


@pytest.mark.parametrize("is_mirrored", [True, False])
def test_a_camera_that_sees_the_gel_mirrored_leaves_a_rig_file(tmp_path, monkeypatch, is_mirrored):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    (tmp_path / "neurotouch").mkdir()
    (tmp_path / "neurotouch/camera.yaml").write_text(f"mirrored: {str(is_mirrored).lower()}\n")
    content = _read_rig("video:")
    (tmp_path / "a.rig.yaml").write_bytes(content)
    assert bool(content) is is_mirrored
    assert load_rig_file(tmp_path / "a.rig.yaml").mirrored is is_mirrored
