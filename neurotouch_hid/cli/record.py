"""``neurotouch record``: writes events and frames, or the pictures of a video, to a file."""

import signal
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from neurotouch_hid import __version__
from neurotouch_hid.cli.record_progress import RecordingProgress
from neurotouch_hid.cli.ui.completing import complete_source
from neurotouch_hid.cli.ui.options import Finite, gel_option
from neurotouch_hid.cli.ui.output import echo, json_option, plain_option, print_json, say
from neurotouch_hid.errors import (
    NeuroTouchError,
    NotRunningError,
    ProfileError,
    RecordingError,
    SourceError,
)
from neurotouch_hid.partial_file import is_plain
from neurotouch_hid.vocabulary import RUNNING_DRIVER, SourceKind, find_source_kind, is_clip

if TYPE_CHECKING:
    from neurotouch_hid.geometry import Gel
    from neurotouch_hid.recording import Recorder, RecorderStats, Sensor, Simulation
    from neurotouch_hid.recording.recorder import Item
    from neurotouch_hid.source import Source
    from neurotouch_hid.vocabulary import Speed

_ENDS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGALRM)
_PATIENCE_S = 10.0
"""Silence of a live source after which a recording with ``--seconds`` ends."""

_MAX_DELAY_US = 10_000_000
"""Longest delay of slices in the camera's queue: a recording needs late slices, too."""


class _Opened(NamedTuple):
    """The opened source, and what a person calls it."""

    name: str
    source: "Source"


class _Silence(KeyboardInterrupt):
    """A live source sends nothing any more."""


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch record clip.aedat4                until Ctrl-C; also while the driver runs\n"
    "  neurotouch record clip.aedat4 --seconds 60 --source davis:00000216\n"
    "  neurotouch record tour.aedat4 --source sim:tour --seconds 20 --json\n"
    "  neurotouch record clip.mkv --source video: --seconds 60\n"
    "  neurotouch record clip.mkv --source file:long.mp4 --seconds 60\n\n"
    "Play it: neurotouch run --source file:clip.aedat4"
)
@click.argument("out", type=click.Path(path_type=Path, dir_okay=False))
@click.option(
    "--source",
    shell_complete=complete_source,
    show_default="the running driver's data, else davis:",
    help="davis:SERIAL or events:SERIAL (a camera), video:NAME (a webcam), file:NAME.aedat4 "
    "(a recording), "
    "file:NAME.mkv (a video clip) or sim:NAME (the simulator).",
)
@click.option("--seconds", type=Finite(min=0.1), help="End after this many seconds of sensor time.")
@click.option(
    "--seed", type=click.IntRange(0), default=0, show_default=True, help="Seed of the simulator."
)
@gel_option
@click.option("--force", is_flag=True, help="Replace OUT if it exists.")
@plain_option
@json_option
def command(
    out: Path,
    source: str | None,
    seconds: float | None,
    seed: int,
    gel: str | None,
    force: bool,
    plain: bool,
    as_json: bool,
) -> None:
    """Record events and frames to the AEDAT4 file OUT, until Ctrl-C or the source ends.

    A video is recorded to OUT.mkv: its pictures and their stamps, as they come.

    While the driver runs, this command records the driver's data, and the game goes on. The file
    stays readable up to the last write: after Ctrl-C, on a full disk, and if the command is killed.

    If a camera or driver ends before --seconds, or is silent for 10 s, a message says so and the
    exit code is 3.
    """
    from neurotouch_hid.source.check import check_source

    if source is None:
        source = _find_live_source()
    check_source(source)
    from neurotouch_hid.driver.gel_file import choose_gel
    from neurotouch_hid.recording import (
        ClipWriter,
        Recorder,
        RecordingWriter,
        write_beside,
        write_gel,
    )
    from neurotouch_hid.source.rig_file import rig_path

    _require_place(out, source, force=force)
    rig = _read_rig(source)
    _spare_handwork(out, gel, has_rig=bool(rig))
    if gel is not None and source == RUNNING_DRIVER:
        raise ProfileError(
            "The driver that runs knows its gel, so --gel has no place here.",
            hint="Leave --gel out. To play another gel: neurotouch run --gel NAME",
        )
    chosen = choose_gel(gel, source)
    fault: NeuroTouchError | None = None
    with ExitStack() as stack:
        # The simulator has no end: without --seconds it is as slow as a camera.
        whole = find_source_kind(source) is not SourceKind.SIMULATION
        opened = _open(stack, source, "max" if seconds or whole else "recorded", seed, chosen.gel)
        stack.callback(_restore_signals)  # before the source is closed: that may hang
        mark = _mark(opened.source, source, seed)
        if is_clip(out):
            recorder = Recorder(ClipWriter(out, simulation=mark))
        else:
            _require_events(opened)
            sensor = _find_sensor(opened.source)
            recorder = Recorder(RecordingWriter(out, in_place=True, simulation=mark, sensor=sensor))
        simulated = "" if mark is None else "SIMULATED "
        echo(f"Recording {simulated}{opened.name} to {out}. Ctrl-C ends.", err=True)
        with RecordingProgress(recorder, out, plain=plain or not sys.stderr.isatty()):
            try:
                with _until_interrupted():
                    _record(opened, recorder, seconds)
            except NeuroTouchError as error:
                fault = error
            finally:
                recorder.close()
        stats, fault = recorder.stats(), recorder.error or fault
        if not stats.events and not stats.frames:
            if is_plain(out):
                out.unlink(missing_ok=True)
            raise fault or RecordingError(
                "Nothing was recorded, so no file was made.",
                hint="Is the camera plugged in? Check: neurotouch doctor",
            )
        try:
            write_gel(out, chosen.file)
            if is_clip(out) or rig:
                write_beside(rig_path(out), rig)
        except RecordingError as error:  # the recording itself is there, which is told first
            fault = fault or error
        _tell(opened.name, out, stats, fault, mark, as_json=as_json)


def _find_sensor(source: "Source") -> "Sensor":
    """Returns the sensor whose pixels the recorded events name."""
    from neurotouch_hid.recording import DAVIS346
    from neurotouch_hid.source import SizedSource

    sensor = source.sensor if isinstance(source, SizedSource) else None
    return sensor or DAVIS346


def _read_rig(source: str) -> bytes:
    """Returns the rig file of a clip: pictures are recorded as they are, mirrored too."""
    from neurotouch_hid.driver.camera_settings import load_camera_config
    from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_bytes
    from neurotouch_hid.source.check import find_path
    from neurotouch_hid.source.rig_file import rig_path

    kind = find_source_kind(source)
    if kind is SourceKind.EVENTS:
        from neurotouch_hid.source.events.gel_place import describe_place

        return describe_place(load_camera_config().events)
    if kind is SourceKind.VIDEO:
        return b"mirrored: true\n" if load_camera_config().video.mirrored else b""
    if not is_clip(source):
        return b""
    beside = rig_path(find_path(source))
    return read_bytes(beside, MAX_SETTINGS_BYTES) if beside.exists() else b""


def _find_live_source() -> str:
    """Returns ``driver:`` while a driver runs, else ``davis:``.

    Raises:
        DriverError: a driver runs, and does not answer.
    """
    from neurotouch_hid.client import ask

    try:
        ask("status")
    except NotRunningError:
        return "davis:"
    return RUNNING_DRIVER


def _require_place(out: Path, source: str, *, force: bool) -> None:
    if out == Path():  # what an empty word becomes
        raise RecordingError(
            "The name of the file is empty.",
            hint="Give one that ends in .aedat4: neurotouch record play.aedat4",
        )
    if out.suffix.lower() not in (".aedat4", ".mkv"):
        raise RecordingError(
            f"'{out}' does not end in .aedat4 or .mkv, the only supported formats.",
            hint="Give a name that ends in .aedat4, or for a video in .mkv.",
        )
    if not out.exists():
        return
    played = Path(source.removeprefix("file:"))
    if played.is_file() and played.samefile(out):
        raise RecordingError(f"'{out}' is source and output at once.", hint="Give another name.")
    if not force:
        raise RecordingError(
            f"'{out}' exists already.", hint="Give another name, or --force to replace it."
        )


def _spare_handwork(out: Path, gel: str | None, *, has_rig: bool) -> None:
    """Refuses a recording beside which labels, a rig or a gel of an older one are kept."""
    from neurotouch_hid.recording import gel_path, labels_path
    from neurotouch_hid.source.rig_file import rig_path

    kept = [labels_path(out), *(() if has_rig or is_clip(out) else (rig_path(out),))]
    if not out.exists() and gel != str(gel_path(out)):
        kept.append(gel_path(out))  # that of a recording that is replaced goes with it
    for made in kept:
        with suppress(OSError):  # its name is too long, so it is not there
            if made.exists():
                raise RecordingError(
                    f"'{made}' belongs to an older recording.",
                    hint="Give another name, or move that file away first.",
                )


def _require_events(opened: _Opened) -> None:
    from neurotouch_hid.source import PictureSource

    if isinstance(opened.source, PictureSource):
        raise RecordingError(
            f"A recording in .aedat4 needs events, and {opened.name} has none.",
            hint="Give a name that ends in .mkv.",
        )


def _open(stack: ExitStack, source: str, speed: "Speed", seed: int, gel: "Gel") -> _Opened:
    from neurotouch_hid.driver.camera_settings import load_camera_config
    from neurotouch_hid.source import open_source

    packets = stack.enter_context(
        open_source(
            source,
            speed=speed,
            seed=seed,
            camera=load_camera_config(),
            max_delay_us=_MAX_DELAY_US,
            gel=gel,
        )
    )
    if source == RUNNING_DRIVER:
        played = packets.name.removeprefix(RUNNING_DRIVER).strip()
        return _Opened(f"{played}, from the running driver", packets)
    return _Opened(packets.name, packets)


def _mark(source: "Source", spec: str, seed: int) -> "Simulation | None":
    """Returns where simulated data come from; None for a sensor's data."""
    from neurotouch_hid.cli.shared.command_line import make_command_line, strip_folders
    from neurotouch_hid.recording import Simulation, find_simulation
    from neurotouch_hid.source.check import find_path
    from neurotouch_hid.source.running_driver import RunningDriver

    if not source.is_simulated:
        return None
    if find_source_kind(spec) is SourceKind.RECORDING:
        return find_simulation(find_path(spec))
    known = source.seed if isinstance(source, RunningDriver) else seed
    program = f"neurotouch-hid {__version__}"
    name = strip_folders(source.name.removeprefix(RUNNING_DRIVER).strip())
    return Simulation(program, name, make_command_line(), known)


def _record(opened: _Opened, recorder: "Recorder", seconds: float | None) -> None:
    """Records until there is enough or the source ends.

    Raises:
        SourceError: a live source ended or fell silent before ``--seconds``.
    """
    is_live = opened.source.is_live
    patience_s = _PATIENCE_S if is_live and seconds is not None else 0.0  # 0: no limit
    begin_us: int | None = None
    signal.setitimer(signal.ITIMER_REAL, patience_s)
    for item, item_begin_us, item_end_us in _items(opened.source):
        signal.setitimer(signal.ITIMER_REAL, patience_s)
        begin_us = item_begin_us if begin_us is None else begin_us
        recorder.take(item, wait=not is_live)
        if recorder.error is not None:
            return
        if seconds is not None and item_end_us - begin_us >= seconds * 1e6:
            return
    if is_live and seconds is not None:
        raise SourceError(f"The source ended before {seconds:g} s were recorded.")


def _items(source: "Source") -> "Iterator[tuple[Item, int, int]]":
    """Gives what is recorded of a source, each with its first and last moment, µs."""
    from neurotouch_hid.source import PictureSource, SizedSource

    if isinstance(source, PictureSource):
        for picture in source.pictures():
            yield picture, picture.exposure_begin_us, picture.exposure_end_us
    else:
        packets = source.sensor_packets() if isinstance(source, SizedSource) else source
        for packet in packets:
            yield packet, packet.t_begin_us, packet.t_end_us


@contextmanager
def _until_interrupted() -> Iterator[None]:
    """Ends the block on Ctrl-C, SIGTERM, SIGHUP or silence, and ignores later signals.

    Raises:
        SourceError: the source was silent.
    """
    ends = [number for number in _ENDS if signal.getsignal(number) is not signal.SIG_IGN]  # nohup

    def interrupt(which: int, _frame: object) -> None:
        for number in ends:
            signal.signal(number, signal.SIG_IGN)
        raise _Silence if which == signal.SIGALRM else KeyboardInterrupt

    try:
        for number in ends:
            signal.signal(number, interrupt)
        yield
    except _Silence:
        raise SourceError(
            f"The source has been silent for {_PATIENCE_S:g} s, so the recording is shorter than "
            "requested.",
            hint="Is the camera plugged in? Check: neurotouch doctor",
        ) from None
    except KeyboardInterrupt:
        pass
    finally:
        for number in ends:
            signal.signal(number, signal.SIG_IGN)


def _restore_signals() -> None:
    """Lets signals end the process as usual from now on: everything is written."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_DFL)


def _tell(
    source: str,
    out: Path,
    stats: "RecorderStats",
    fault: NeuroTouchError | None,
    mark: "Simulation | None",
    *,
    as_json: bool,
) -> None:
    """Reports the recorded data; raises the error that ended it, or puts it into the JSON."""
    lost = stats.lost_before + stats.lost_here
    status = "WARNING" if lost or fault is not None else "OK"
    simulated = "" if mark is None else "SIMULATED "
    message = (
        f"{out} has {stats.seconds:.1f} s of {simulated}{source}: {stats.events:,} events, "
        f"{stats.frames:,} frames, {stats.size_bytes / 1e6:.1f} MB."
    )
    if stats.lost_before:
        message += f" {stats.lost_before:,} events were lost in the camera or the driver."
    if stats.lost_here:
        why = ", the disk was too slow" if fault is None else ""
        message += f" {stats.lost_here:,} events were dropped{why}."
    if not as_json:
        say(status, message)
        if fault is not None:
            raise fault
        return
    report: dict[str, Any] = {"status": status, "message": message, "fix": None}
    if fault is not None:
        report |= {"status": "FAILED", "error": fault.message, "fix": fault.hint}
    origin = None if mark is None else asdict(mark)
    about = {"file": str(out), "source": source, "simulation": origin}
    print_json({**report, **about, **asdict(stats)})
    if fault is not None:
        sys.exit(fault.exit_code)
