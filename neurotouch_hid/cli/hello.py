"""``neurotouch hello``: the first minutes with a camera, and one file of what it showed."""

import shlex
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from neurotouch_hid import __version__
from neurotouch_hid.cli.shared.silent_driver import is_guided, open_silent_driver
from neurotouch_hid.cli.shared.telling import Telling, open_option, page_option, start_page
from neurotouch_hid.cli.ui.completing import complete_own_source
from neurotouch_hid.cli.ui.options import seed_option
from neurotouch_hid.cli.ui.output import echo, plain_option, require_writable, say
from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.vocabulary import SourceKind, find_source_kind

if TYPE_CHECKING:
    from neurotouch_hid.cli.ui.keyboard import Keyboard
    from neurotouch_hid.doctor.hello.session import Session
    from neurotouch_hid.messages import Step
    from neurotouch_hid.recording import Recorder
    from neurotouch_hid.source import Source

_KEYS = (
    "Enter = done, next. A letter, then Enter: S = I cannot do this, R = begin this one again, "
    "Q = stop and save nothing."
)
_BUTTONS = [
    ("", "Done, next"),
    ("s", "I cannot do this"),
    ("r", "Begin this one again"),
    ("q", "Stop and save nothing"),
]
_FIRST = {"title": "Meet a camera", "request": "The camera is being opened."}
_MOST_RECORDED_US = 600_000_000
"""Ten minutes; who takes longer is measured, but no longer recorded."""


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch hello                         the camera that is plugged in\n"
    "  neurotouch hello desk --source video:    a webcam; writes desk.hello.zip\n"
    "  neurotouch hello --open                  at a page in your browser, too\n"
    "  neurotouch hello --source sim:tour       to see how it goes, without a camera"
)
@click.argument("name", default="camera")
@click.option(
    "--source",
    shell_complete=complete_own_source,
    show_default="the DAVIS that is plugged in, or else the video camera",
    help="davis:SERIAL, video:NAME or events:SERIAL (a camera), file:NAME.aedat4 (a recording) "
    "or sim:NAME (the simulator).",
)
@seed_option
@click.option(
    "--led",
    type=click.Path(path_type=Path),
    help="The file that switches an LED, to measure latency: 'brightness' in a folder of "
    "/sys/class/leds.",
)
@click.option("--force", is_flag=True, help="Replace the file if it exists.")
@page_option
@open_option
@plain_option
def command(
    name: str,
    source: str | None,
    seed: int,
    led: Path | None,
    force: bool,
    with_page: bool,
    open_browser: bool,
    plain: bool,
) -> None:
    """Meet a camera for the first time: about three minutes, and nothing is timed.

    You are asked for a rest and six movements. Each waits until you press Enter. Then sentences say
    what your camera has answered about real hardware, and how it differs from the simulated one.
    NAME.hello.zip keeps a recording, what you were asked for, the answers, and settings of the
    simulator for more like it. Nothing is sent. The pictures show what the camera sees. Nothing is
    written to the camera but what play writes. --page asks and answers at a page too, by keyboard
    or mouse.
    """
    from neurotouch_hid.source.check import check_source

    out = _find_place(name, force=force)
    source = source or _find_camera()
    check_source(source)
    if find_source_kind(source) is SourceKind.DRIVER:
        raise NeuroTouchError(
            "'hello' needs the camera itself, not what the running driver sees.",
            hint="Stop the driver (neurotouch stop), then: neurotouch hello",
        )
    from neurotouch_hid.cli.ui.keyboard import Keyboard
    from neurotouch_hid.cli.ui.voice import Voice
    from neurotouch_hid.doctor.hello.archive import make_report, make_settings, write_archive
    from neurotouch_hid.doctor.hello.camera_facts import (
        judge_stream,
        list_serials,
        read_davis,
        read_opened,
        read_stream,
    )
    from neurotouch_hid.doctor.hello.led import LedMeter
    from neurotouch_hid.doctor.hello.session import Session
    from neurotouch_hid.driver.gel_file import find_gel_file, load_gel_file
    from neurotouch_hid.gel_making.plan import make_plan
    from neurotouch_hid.profile import load_user

    gel_path = find_gel_file(None, source)
    gel_file = load_gel_file(gel_path)
    plan = make_plan(gel_file.settings, is_made=True)
    guided = is_guided(source, "recorded")
    kind = find_source_kind(source)
    if led is not None and not guided:
        raise NeuroTouchError("No recording shows an LED now.", hint="Leave --led out.")
    with ExitStack() as stack:
        meter = None if led is None else stack.enter_context(LedMeter(led))
        page = None
        if with_page or open_browser:
            page = start_page(stack, _BUTTONS, open_browser=open_browser, **_FIRST)
        told = Telling(stack.enter_context(Voice(load_user().feedback)), page)
        camera, secrets = read_davis(source)
        driver = stack.enter_context(
            open_silent_driver(source, "recorded" if guided else "max", seed)
        )
        camera = camera or read_opened(driver.source)
        session = Session(plan, str(kind), guided=guided, led=meter)
        folder = tempfile.TemporaryDirectory(prefix=".hello-", dir=out.parent)
        kept = Path(stack.enter_context(folder))
        recording = _open_recorder(stack, kept, driver.source, source, seed)
        if driver.source.is_simulated:
            told.show(simulated=True)
            told.say("SIMULATED: this is no camera.")
        steps = _record(driver.steps(), recording)
        try:
            if guided:
                _guide(session, steps, driver.source, Keyboard(), told)
            else:
                for step in steps:
                    session.take(step, _find_view(driver.source))
            session.finish()
        except (click.Abort, KeyboardInterrupt, NeuroTouchError):
            told.say("Nothing was saved.")
            raise
        path = recording.finish()
        camera |= read_stream(driver.source)
        seconds = 1e-6 * (session.end_us - (session.begin_us or 0))
        is_simulated = driver.source.is_simulated
        report = make_report(
            session,
            kind,
            camera,
            is_simulated=is_simulated,
            secrets=secrets | list_serials(driver.source),
            stream=judge_stream(driver.source, plan.gel, seconds),
        )
        own_gel = None if gel_path is None else gel_file
        settings = make_settings(session, own_gel, camera, is_simulated=is_simulated)
        try:
            write_archive(out, report, session.spans, path, settings)
        except OSError as error:
            raise NeuroTouchError.of_writing(out, error) from error
        _tell(report, told, plain=plain)
        told.say(f"All of it is in {out}. Nothing was sent.")
        if settings:
            echo(f"More recordings like it: neurotouch simulate OUT --like {shlex.quote(str(out))}")
        echo("Left out of the answers: " + "; ".join(report["left_out"]) + ".")
        echo("The recording shows what the camera saw. Look at it before you send it.")


def _find_place(name: str, *, force: bool) -> Path:
    """Returns the path of the file.

    Raises:
        NeuroTouchError: it exists already, or cannot be written.
    """
    from neurotouch_hid.doctor.hello.archive import ENDING

    out = Path(name if name.endswith(ENDING) else f"{name}{ENDING}")
    if out.exists() and not force:
        raise NeuroTouchError(
            f"'{out}' exists already.", hint="Give another name, or --force to replace it."
        )
    require_writable(out)
    return out


def _find_camera() -> str:
    """Returns the source of the camera that is plugged in; a DAVIS, if none is."""
    from neurotouch_hid.source.davis import find_cameras
    from neurotouch_hid.source.video.enumeration import find_video_cameras

    return "video:" if not find_cameras() and find_video_cameras() else "davis:"


class _Recording:
    """Records a session.

    Args:
        recorder: writes it.
        path: where.
    """

    def __init__(self, recorder: "Recorder", path: Path) -> None:
        self._recorder, self._path = recorder, path
        self._begin_us: int | None = None

    def take(self, step: "Step") -> None:
        """Records a slice; those after ten minutes are left out."""
        packet = step.packet
        if self._begin_us is None:
            self._begin_us = packet.t_begin_us
        if packet.t_end_us - self._begin_us <= _MOST_RECORDED_US:
            self._recorder.take(packet)

    def finish(self) -> Path:
        """Finishes the file and returns its path.

        Raises:
            RecordingError: it could not be written.
        """
        self._recorder.close()
        if self._recorder.error is not None:
            raise self._recorder.error
        return self._path


def _open_recorder(
    stack: ExitStack, folder: Path, source: "Source", spec: str, seed: int
) -> _Recording:
    """Begins the recording: events and frames, or of a video the frames, cut to the gel."""
    from neurotouch_hid.recording import (
        ClipWriter,
        Recorder,
        RecordingWriter,
        Simulation,
        find_simulation,
    )
    from neurotouch_hid.source import PictureSource
    from neurotouch_hid.source.check import find_path

    mark = None
    if source.is_simulated:
        mark = Simulation(f"neurotouch-hid {__version__}", spec, "neurotouch hello", seed)
        if find_source_kind(spec) is SourceKind.RECORDING:
            mark = find_simulation(find_path(spec))
    is_video = isinstance(source, PictureSource)
    path = folder / ("recording.mkv" if is_video else "recording.aedat4")
    writer = (
        ClipWriter(path, simulation=mark)
        if is_video
        else RecordingWriter(path, in_place=True, simulation=mark)
    )
    recorder = Recorder(writer)
    stack.callback(recorder.close)
    return _Recording(recorder, path)


def _record(steps: Iterator["Step"], recording: _Recording) -> Iterator["Step"]:
    for step in steps:
        recording.take(step)
        yield step


def _find_view(source: "Source") -> Any:
    from neurotouch_hid.source import PictureSource

    return source.view if isinstance(source, PictureSource) else None


def _guide(
    session: "Session",
    steps: Iterator["Step"],
    source: "Source",
    keyboard: "Keyboard",
    told: "Telling",
) -> None:
    """Asks for one thing after the other; what is pressed decides when it goes on."""
    n_prompts, warned = session.n_prompts, False
    asked = None
    for step in steps:
        heard = session.take(step, _find_view(source))
        prompt = session.prompt
        if prompt is None:
            return
        if prompt is not asked:
            if asked is None:
                told.say(_KEYS)
            asked, warned = prompt, False
            n_done = len(session.spans)
            told.show(request=prompt.request, n_done=n_done, n_requests=n_prompts)
            told.say(f"{n_done + 1} of {n_prompts}. {prompt.request}")
        elif heard:
            told.say(heard)
        told.show(missing=session.missing)
        key = told.poll(keyboard)
        if key is not None:
            warned = _press(session, key.lower(), told, warned=warned)
    told.say("The source has ended.")


def _press(session: "Session", key: str, told: "Telling", *, warned: bool) -> bool:
    """Acts on a line from the keyboard: Enter, S, R or Q.

    Returns:
        Whether the person has now been told that something is missing.
    """
    match key:
        case "" if session.missing and not warned:
            told.say(f"{session.missing} To go on all the same, press Enter once more.")
            return True
        case "":
            session.next()
        case "s":
            session.next(is_skipped=True)
        case "r":
            session.restart()
            told.say("Again.")
        case "q":
            raise click.Abort
        case _:
            told.say(_KEYS)
            return warned
    return False


def _tell(report: dict[str, Any], told: "Telling", *, plain: bool) -> None:
    """Says what was answered, a sentence each."""
    n_answered = sum(each["word"] != "not in this run" for each in report["answers"])
    rows = [
        {"word": each["word"], "name": each["point"], "sentence": each["sentence"]}
        for each in report["answers"]
    ]
    differences = [each["sentence"] for each in report["differences"]]
    rows += [{"word": "", "name": "", "sentence": sentence} for sentence in differences]
    told.show(results=rows)
    told.say(f"Answered: {n_answered} of {len(report['answers'])} open questions about hardware.")
    for each in report["answers"]:
        say(each["word"].upper(), f"{each['point']}: {each['sentence']}", plain=plain)
    echo("This gel and camera beside the simulated ones:")
    for sentence in differences:
        echo(sentence)
