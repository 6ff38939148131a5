"""Runs a driver with monitors for ``run`` and ``demo``, and prints a summary at the end."""

import shutil
import sys
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from neurotouch_hid.cli.ui.output import echo, is_plain
from neurotouch_hid.gel_sentences import explain_gel
from neurotouch_hid.messages import GelProblem
from neurotouch_hid.monitor import LinesMonitor, PictureMonitor, TraceWriter
from neurotouch_hid.monitor.terminal import READINGS
from neurotouch_hid.monitor.text_output import TextOutput
from neurotouch_hid.process.signals import TerminalStop, stop_on_signals

if TYPE_CHECKING:
    from neurotouch_hid.driver import Driver
    from neurotouch_hid.profile import MappingDecision
    from neurotouch_hid.runtime import Tap


def play(
    driver: "Driver", *, show: str, trace: Path | None = None, seconds: float | None = None
) -> None:
    """Runs a driver with the chosen monitors until its source ends, a signal comes or time is up.

    Args:
        driver: the opened driver.
        show: ``picture``, ``lines``, ``nothing``, or ``auto``: a picture on a terminal, but lines
            elsewhere, on a narrow one and where plain output is asked for.
        trace: file for one JSON line per slice.
        seconds: ends after this much sensor time.
    """
    if show == "auto":
        is_narrow = shutil.get_terminal_size().columns < READINGS
        show = "lines" if is_plain() or is_narrow else "picture"
    stop = stop_on_signals(driver.reload if driver.options.is_listening else None)
    title = f"{driver.source.name} -> {driver.device.name}, profile {driver.profile.name}"
    if driver.source.is_simulated:
        title = f"SIMULATED {title}"
    announce = partial(echo, err=True)
    announce(f"Gamepad ready: {title}. Ctrl-C ends.")

    def read_decisions() -> "tuple[MappingDecision, ...]":
        return driver.pipeline.mapping.decisions()  # other values of the person: a new mapping

    with ExitStack() as stack:
        taps: list[Tap] = []
        picture: PictureMonitor | None = None
        if trace is not None:
            writer = TraceWriter(trace, announce)
            stack.callback(writer.close)
            taps.append(writer)
        if show != "nothing":
            out = TextOutput(sys.stdout, "the output", announce)
            if show == "picture":
                picture = PictureMonitor(out, title)
            monitor = picture or LinesMonitor(out, read_decisions)
            stack.callback(monitor.close)
            taps.append(monitor)

        def prepare_stop() -> None:
            driver.device.neutral()
            if picture is not None:
                picture.leave()

        terminal_stop = TerminalStop(prepare_stop)
        stack.callback(terminal_stop.close)
        stats = driver.run(taps, seconds=seconds, stop=stop, on_round=terminal_stop.take)
    gel = driver.pipeline.gel
    if stats.slices and (not gel.is_found or gel.problem is GelProblem.EVENTS_ONLY):
        sentence = explain_gel(gel)
        announce(f"Warning: at the end the gel is {sentence.text}. {sentence.fix}".rstrip())
    speed = ""
    if stats.host_s and driver.options.speed == "max":
        speed = f", {stats.sensor_s / stats.host_s:.1f} times as fast"
    announce(f"Played {stats.sensor_s:.1f} s{speed}, {stats.events:,} events. The pad is neutral.")
