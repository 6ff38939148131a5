"""What ``run`` and ``demo`` share: play a driver, show what it does, say what happened."""

import sys
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import TYPE_CHECKING

import click

from neurotouch_hid.driver.signals import stop_on_signals
from neurotouch_hid.monitor import LinesMonitor, PictureMonitor, TraceWriter

if TYPE_CHECKING:
    from neurotouch_hid.driver import Driver
    from neurotouch_hid.runtime import Tap


def play(
    driver: "Driver", *, show: str, trace: Path | None = None, seconds: float | None = None
) -> None:
    """Runs a driver with the chosen monitors until its source ends, a signal comes or time is up.

    Args:
        driver: what to run; open.
        show: ``picture``, ``lines``, ``nothing``, or ``auto``: a picture on a terminal, else lines.
        trace: file for one JSON line per slice.
        seconds: ends after so much sensor time.
    """
    if show == "auto":
        show = "picture" if sys.stdout.isatty() else "lines"
    stop = stop_on_signals(driver.reload if driver.options.is_listening else None)
    title = f"{driver.source.name} → {driver.device.name}, profile {driver.profile.name}"
    if driver.source.is_simulated:
        title = f"SIMULATED {title}"
    click.echo(f"Gamepad ready: {title}. Ctrl-C ends.", err=True)
    with ExitStack() as stack:
        taps: list[Tap] = []
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
        stats = driver.run(taps, seconds=seconds, stop=stop)
    seen = driver.pipeline.rest.detector.stats()
    if seen.n_references and not seen.n_frames:
        click.echo(f"Warning: the gel was {seen.reason}.", err=True)
    speed = f", {stats.sensor_s / stats.host_s:.1f} times real time" if stats.host_s else ""
    click.echo(
        f"Played {stats.sensor_s:.1f} s of sensor time, {stats.events:,} events{speed}. "
        "The pad is neutral.",
        err=True,
    )


def announce(sentence: str) -> None:
    """Tells the person a sentence on the standard error."""
    with suppress(OSError):  # the terminal has gone, or the disk that keeps it is full
        click.echo(sentence, err=True)
