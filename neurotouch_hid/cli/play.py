"""What ``run`` and ``demo`` share: prepare the line, play it, say what happened."""

import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from itertools import islice
from pathlib import Path

import click

from neurotouch_hid.device import Device
from neurotouch_hid.driver.signals import stop_on_signals
from neurotouch_hid.driver.wiring import Live
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import EventPacket
from neurotouch_hid.monitor import LinesMonitor, PictureMonitor, TraceWriter
from neurotouch_hid.process.realtime import hurry
from neurotouch_hid.profile import Profile
from neurotouch_hid.runtime import Pipeline, Tap, run_line, warm_up
from neurotouch_hid.source import Source, open_source

_PATIENCE_S = 1.0
_WARM_SLICES = 5  # up to the first frame


def prepare_kernels(profile: Profile, gesture: GestureConfig, source: str) -> None:
    """Loads the compiled kernels of the line and of the source; says so if they must be compiled.

    Of the sources only the simulator has kernels of its own that a first slice must not wait for.

    Args:
        profile: what the gestures mean.
        gesture: how they are recognised.
        source: what will be played, as the user wrote it.
    """
    with _notice("Loading (the first time compiles for this processor, half a minute) ..."):
        warm_up(Pipeline.build(profile, gesture))
        if source.startswith("sim:"):
            with open_source(source, speed="max") as first_slices:
                for _ in islice(first_slices, _WARM_SLICES):
                    pass


def play(
    source: Source,
    pipeline: Pipeline,
    device: Device,
    *,
    title: str,
    show: str,
    trace: Path | None = None,
    seconds: float | None = None,
    live: Live | None = None,
) -> None:
    """Runs the line with the chosen taps until the source ends, a signal comes or time is up.

    Args:
        source: what to play.
        pipeline: the line.
        device: the pad.
        title: the first line of the picture.
        show: ``picture``, ``lines``, ``nothing``, or ``auto``: a picture on a terminal, else lines.
        trace: file for one JSON line per slice.
        seconds: end after so much sensor time.
        live: what the line listens to while it plays.
    """
    if show == "auto":
        show = "picture" if sys.stdout.isatty() else "lines"
    stop = stop_on_signals(live.reload if live is not None else None)
    click.echo(f"Gamepad ready: {title}. Ctrl-C ends.", err=True)
    packets = source if seconds is None else _for_seconds(source, seconds)
    with ExitStack() as stack:
        taps: list[Tap] = [] if live is None else [*live.taps]
        if trace is not None:
            writer = TraceWriter(trace)
            stack.callback(writer.close)
            taps.append(writer)
        if show != "nothing":
            monitor = (
                PictureMonitor(sys.stdout, title) if show == "picture" else LinesMonitor(sys.stdout)
            )
            stack.callback(monitor.close)
            taps.append(monitor)
        session = live.session if live is not None else None
        if live is not None:
            stack.enter_context(hurry())
        stats = run_line(packets, pipeline, device, taps, stop=stop, session=session)
    seen = pipeline.rest.detector.stats()
    if seen.n_references and not seen.n_frames:
        click.echo(f"Warning: the gel was {seen.reason}.", err=True)
    speed = f", {stats.sensor_s / stats.host_s:.1f} times real time" if stats.host_s else ""
    click.echo(
        f"Played {stats.sensor_s:.1f} s of sensor time, {stats.events:,} events{speed}. "
        "The pad is neutral.",
        err=True,
    )


def _for_seconds(packets: Source, seconds: float) -> Iterator[EventPacket]:
    begin_us: int | None = None
    for packet in packets:
        begin_us = packet.t_begin_us if begin_us is None else begin_us
        yield packet
        if packet.t_end_us - begin_us >= seconds * 1e6:
            return


@contextmanager
def _notice(text: str) -> Iterator[None]:
    timer = threading.Timer(_PATIENCE_S, click.echo, (text,), {"err": True})
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
