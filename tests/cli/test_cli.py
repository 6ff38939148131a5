"""The command line as a user meets it: in a process of its own."""

import json
import os
import pty
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from neurotouch_hid.source.simulator import find_scene, scene_names
from tests.processes import run_command, run_neurotouch, start_neurotouch


def neurotouch(*arguments, **kwargs):
    return run_neurotouch(*arguments, code=None, **kwargs)


def wait_ready(process):
    for line in process.stderr:
        if line.startswith("Gamepad ready"):
            return
    raise AssertionError("no gamepad appeared")


def assert_ended(process, said):
    """Interrupted; or it played already, and a signal is an orderly end."""
    ends = {(130, "Stopped."), (0, "Played")}
    assert (process.returncode, said.splitlines()[-1].split()[0]) in ends
    assert "Traceback" not in said


HEAVY = ("numpy", "numba", "cv2", "pydantic", "ruamel", "evdev")


def test_help_imports_nothing_heavy():
    code = (
        "import sys; from neurotouch_hid.cli.main import cli\n"
        "cli.main(['--help'], standalone_mode=False)\n"
        f"print([name for name in {HEAVY!r} if name in sys.modules])"
    )
    done = run_command(sys.executable, "-c", code)
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize("command", ["run", "calibrate", "record x.aedat4"])
@pytest.mark.parametrize("source", ["", "davis:", "davis:1", "file:x.aedat4", "foo:"])
def test_a_source_that_is_not_there_is_refused_before_anything_heavy_is_imported(
    command, source, tmp_path, monkeypatch
):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path))  # no driver
    words = [*command.split(), *(["--source", source] if source else [])]
    code = (
        "import sys\n"
        "from neurotouch_hid.cli.main import cli\n"
        "from neurotouch_hid.errors import NeuroTouchError\n"
        "try:\n"
        f"    cli.main({words!r}, standalone_mode=False)\n"
        "except NeuroTouchError as error:\n"
        "    print(error.exit_code, [name for name in ('numba', 'evdev') if name in sys.modules])"
    )
    done = run_command(sys.executable, "-c", code, code=None)
    assert done.stdout.strip() in ("3 []", "4 []"), done.stderr


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_is_a_script_for_the_shell(shell):
    done = neurotouch("completion", shell)
    assert done.returncode == 0
    assert "_NEUROTOUCH_COMPLETE" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "code", "sentence"),
    [
        (["rum"], 2, "There is no command 'rum'.\nFix: Did you mean: neurotouch run\n"),
        (["quit"], 2, "Did you mean: neurotouch stop"),
        (["calibrat"], 2, "Did you mean: neurotouch calibrate"),
        (["profile", "lst"], 2, "Did you mean: neurotouch profile list"),
        (["qqq"], 2, "All commands: "),
        (["run", "--speed", "warp"], 2, "Option --speed cannot be 'warp'."),
        (["run", "--source", "davis:"], 3, "No DAVIS camera"),
        (["run", "--source", "sim:tuor", "--device", "memory"], 3, "sim:tour"),
        (["run", "--source", "file:nothing.aedat4", "--device", "memory"], 4, "nothing.aedat4"),
        (["run", "--source", "sim:tour", "--profile", "spacecrat"], 6, "spacecraft"),
        (["run"], 3, "Without a camera: neurotouch demo, or the source sim:tour."),
        (["calibrate"], 3, "To rehearse it: neurotouch demo --mouse"),
        (["calibrate", "--source", "sim:mouse"], 3, "Start it: neurotouch demo --mouse."),
        (
            ["run", "--source", "sim:tour", "--identity", "playstation", "--device", "memory"],
            *(7, "so 'playstation' has no effect.\nFix: Leave out --identity, or choose --device"),
        ),
        (
            ["run", "--source", "sim:tour", "--identity", "plastation", "--device", "memory"],
            *(7, "There is no identity called 'plastation'."),
        ),
        (["evaluate", "nothing.aedat4"], 4, "There is no file 'nothing.aedat4'"),
        (["evaluate", "."], 4, "is a folder.\nFix: Give its recordings: "),
    ],
)
def test_wrong_input_ends_with_a_sentence_and_its_exit_code(arguments, code, sentence):
    done = neurotouch(*arguments)
    assert done.returncode == code
    assert sentence in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.skipif(Path("/dev/uinput").exists(), reason="this machine has /dev/uinput")
def test_run_without_uinput_says_how_to_get_it():
    done = neurotouch("run", "--source", "sim:push")
    assert done.returncode == 7
    assert "/dev/uinput" in done.stderr
    assert "Fix:" in done.stderr


def test_demo_ends_by_itself_and_shows_the_pad_moving():
    done = neurotouch("demo", "--seconds", "3")
    assert done.returncode == 0
    assert "push up" in done.stdout
    assert re.search(r"left stick .*up \d", done.stdout)
    assert "The pad is neutral." in done.stderr


def test_demo_repeats_its_scene_until_the_seconds_are_over():
    done = neurotouch("demo", "--scene", "pinch", "--seconds", "6", "--no-page")
    assert done.returncode == 0
    assert done.stdout.count("pinch") >= 2
    assert "Played 6.0 s" in done.stderr


def test_run_ends_after_its_seconds(tmp_path):
    trace = tmp_path / "tour.jsonl"
    options = ("--source", "sim:tour", "--device", "memory", "--speed", "max", "--trace", trace)
    done = neurotouch("run", "--seconds", "1.5", *options)
    assert done.returncode == 0
    assert len(trace.read_text().splitlines()) == 150
    assert "Played 1.5 s" in done.stderr


def test_run_names_the_scenes_that_never_end_and_lists_all():
    said = " ".join(neurotouch("run", "--help").stdout.split())
    again = said.split("Of the simulated scenes ")[1].split(" repeat for ever; all others end ")[0]
    endless = {name for name in scene_names() if find_scene(name).endless}
    assert set(again.replace(" and ", ", ").split(", ")) == endless
    listed = neurotouch("run", "--source", "sim:")
    assert f"Fix: Scenes: {', '.join(scene_names())}." in listed.stderr


def test_run_writes_a_trace_with_one_line_per_slice(tmp_path):
    trace = tmp_path / "push.jsonl"
    done = neurotouch(
        "run", "--source", "sim:push", "--device", "memory", "--speed", "max", "--trace", trace
    )
    assert done.returncode == 0
    lines = [json.loads(line) for line in trace.read_text().splitlines()]
    stamps = [line["t_us"] for line in lines]
    assert stamps == list(range(10_000, 10_000 * (len(lines) + 1), 10_000))
    assert "push" in {line["gesture"] for line in lines}
    assert not any(lines[-1]["pad"].values())


def test_run_takes_as_many_slices_a_second_as_wanted(tmp_path):
    trace = tmp_path / "push.jsonl"
    options = ("--source", "sim:push", "--device", "memory", "--speed", "max", "--trace", trace)
    assert neurotouch("run", "--rate", "250", *options).returncode == 0
    stamps = [json.loads(line)["t_us"] for line in trace.read_text().splitlines()]
    assert stamps == list(range(4_000, 4_000 * (len(stamps) + 1), 4_000))
    assert len(stamps) > 100


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("n_times", [1, 2])
def test_signal_while_playing_is_an_orderly_end(number, n_times):
    process = start_neurotouch(
        "run", "--source", "sim:tour", "--device", "memory", "--show", "nothing"
    )
    wait_ready(process)
    for _ in range(n_times):
        process.send_signal(number)
    _, rest = process.communicate(timeout=300)
    # A second one may come when all is done, and then ends what is left of the process.
    assert process.returncode in ((0,) if n_times == 1 else (0, -number))
    assert "The pad is neutral." in rest
    assert "Traceback" not in rest


@pytest.mark.parametrize("library", ["numpy", "pydantic_core", "_helperlib"])  # the last: kernels
def test_ctrl_c_while_libraries_are_imported_is_no_traceback(library):
    process = start_neurotouch(
        "run", "--source", "sim:tour", "--device", "memory", "--show", "nothing"
    )
    maps = Path(f"/proc/{process.pid}/maps")
    while library not in maps.read_text():
        assert process.poll() is None
        time.sleep(0.001)
    process.send_signal(signal.SIGINT)
    _, text = process.communicate(timeout=300)
    assert_ended(process, text)


@pytest.mark.parametrize(
    "command", [("emulate", "--usb2"), ("bench", "soak"), ("bench", "curves", "x")]
)
def test_who_lacks_the_development_tools_is_told_how_to_get_them(command):
    program = (
        "import sys; sys.modules['neurotouch_devtools'] = None\n"
        "from neurotouch_hid.__main__ import main; main()"
    )
    done = run_command(sys.executable, "-c", program, *command, code=1)
    assert "belongs to the development tools" in done.stderr
    assert "pip install ./devtools" in done.stderr


PLAY = [
    "run",
    "--source",
    "sim:press",
    "--device",
    "memory",
    "--speed",
    "max",
    "--seconds",
    "1",
    "--show",
    "lines",
]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """The trace of a run whose outputs can all be written."""
    path = tmp_path_factory.mktemp("undisturbed") / "play.jsonl"
    assert neurotouch(*PLAY, "--trace", path).returncode == 0
    return path.read_text()


@pytest.mark.parametrize("lost", ["full", "closed"])
def test_an_output_that_is_lost_does_not_end_the_game(tmp_path, undisturbed, lost):
    path = tmp_path / "play.jsonl"
    read, closed = os.pipe()
    os.close(read)
    full = os.open("/dev/full", os.O_WRONLY)
    done = subprocess.run(
        [sys.executable, "-m", "neurotouch_hid", *PLAY, "--trace", path],
        stdout=full if lost == "full" else closed,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    os.close(full)
    os.close(closed)
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("the output cannot be written") == 1
    assert "The pad is neutral." in done.stderr
    assert path.read_text() == undisturbed


def test_a_terminal_too_narrow_for_the_picture_gets_lines():
    ours, theirs = pty.openpty()
    try:
        done = subprocess.run(
            [sys.executable, "-m", "neurotouch_hid", *PLAY[:-2], "--show", "auto"],
            stdout=theirs,
            stderr=subprocess.PIPE,
            check=False,
            env={**os.environ, "TERM": "xterm", "NT_ACCESSIBLE": "", "COLUMNS": "30"},
        )
        said = os.read(ours, 1 << 16)
    finally:
        os.close(ours)
        os.close(theirs)
    assert done.returncode == 0, done.stderr
    assert b"\x1b" not in said
    assert b"pad neutral" in said


def test_a_trace_on_a_full_disk_does_not_end_the_game():
    done = neurotouch(*PLAY, "--trace", "/dev/full")
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("the trace /dev/full cannot be written") == 1
    assert "The pad is neutral." in done.stderr


def test_nothing_can_be_said_and_the_game_goes_on(tmp_path, undisturbed):
    path = tmp_path / "play.jsonl"
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "neurotouch_hid", *PLAY, "--trace", path],
            stdout=full,
            stderr=full,
            check=False,
        )
    assert done.returncode == 0
    assert path.read_text() == undisturbed


@pytest.mark.parametrize("closed", [">&-", "2>&-", "<&- >&- 2>&-"])
@pytest.mark.parametrize("words", ["--version", "profile list", "status", "pause", "profile x"])
def test_closed_outputs_are_as_if_nobody_read_them(tmp_path, words, closed):
    environment = {**os.environ, "XDG_CONFIG_HOME": str(tmp_path), "XDG_RUNTIME_DIR": str(tmp_path)}
    call = f"{sys.executable} -m neurotouch_hid {words}"
    codes = [
        subprocess.run(["sh", "-c", each], capture_output=True, check=False, env=environment)
        for each in (call, f"{call} {closed}")
    ]
    assert codes[1].returncode == codes[0].returncode
    assert codes[1].stderr in (codes[0].stderr, b"")
    assert codes[1].stdout in (codes[0].stdout, b"")


@pytest.mark.parametrize(
    ("words", "code"), [("rnu", 2), ("status", 8), ("pause", 8), ("profile show nobody", 6)]
)
def test_an_error_that_nobody_can_read_has_its_exit_code(tmp_path, words, code):
    environment = {
        **os.environ,
        "XDG_CONFIG_HOME": str(tmp_path),
        "RUNTIME_DIRECTORY": str(tmp_path),
    }
    call = [sys.executable, "-m", "neurotouch_hid", *words.split()]
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(call, stdout=full, stderr=full, check=False, env=environment)
    assert done.returncode == code


FAILING = """\
import sys
from neurotouch_hid.cli import devices
def fail(**_):
    raise EOFError("half a file")
devices.command.callback = fail
from neurotouch_hid.__main__ import main
sys.argv = ["neurotouch", "devices"]
main()
"""


@pytest.mark.parametrize("words", ["--help", "profile list", "profile show default"])
def test_a_reader_that_has_seen_enough_is_no_failure(words):
    seen, output = os.pipe()
    os.close(seen)  # as `neurotouch profile list | head` does
    try:
        outputs = {"capture_output": False, "stdout": output, "stderr": subprocess.PIPE}
        done = run_neurotouch(*words.split(), **outputs)
    finally:
        os.close(output)
    assert done.stderr == ""


def test_too_little_memory_is_said():
    done = run_command(
        sys.executable, "-c", FAILING.replace('EOFError("half a file")', "MemoryError"), code=1
    )
    assert done.stderr.startswith("Error: There is not enough memory.\nFix: ")


def test_a_recording_is_made_though_nobody_can_read_what_is_said(tmp_path):
    out = tmp_path / "clip.aedat4"
    words = ["record", str(out), "--source", "sim:push", "--seconds", "0.2"]
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "neurotouch_hid", *words],
            stdout=subprocess.DEVNULL,
            stderr=full,
            check=False,
        )
    assert done.returncode == 0
    assert out.stat().st_size > 100_000


def test_the_end_of_a_file_is_not_taken_for_ctrl_d():
    done = run_command(sys.executable, "-c", FAILING, code=1)
    assert "EOFError: half a file" in done.stderr
    assert "Stopped." not in done.stderr


def test_the_help_says_how_a_screen_reader_gets_lines():
    assert "NT_ACCESSIBLE=1" in neurotouch("--help").stdout
    assert "screen readers" in neurotouch("run", "--help").stdout
