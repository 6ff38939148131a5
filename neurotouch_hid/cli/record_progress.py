"""The progress of a recording, in words."""

import logging
import shutil
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Self

import click

if TYPE_CHECKING:
    from neurotouch_hid.recording import Recorder, RecorderStats

_TERMINAL_S, _PLAIN_S = 1.0, 10.0
"""Interval of progress reports: in one line on a terminal, else line by line."""


class _AboveLine(logging.Handler):
    """Writes log messages above the line of progress, not into it."""

    def emit(self, record: logging.LogRecord) -> None:
        click.echo(f"\r\x1b[K{self.format(record)}", err=True)


class RecordingProgress:
    """Reports progress in a separate thread, so that it also appears while the source is silent.

    Args:
        recorder: what records.
        out: the file; the space left on its disk is told.
        plain: write line by line, not over one line of a terminal.
    """

    def __init__(self, recorder: "Recorder", out: Path, *, plain: bool) -> None:
        self._recorder, self._folder, self._plain = recorder, out.parent, plain
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._work, name="progress", daemon=True)
        self._above = _AboveLine()

    def __enter__(self) -> Self:
        if not self._plain:
            logging.getLogger("neurotouch_hid").addHandler(self._above)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._done.set()
        self._thread.join()
        logging.getLogger("neurotouch_hid").removeHandler(self._above)

    def _work(self) -> None:
        period_s = _PLAIN_S if self._plain else _TERMINAL_S
        before = self._recorder.stats()
        while not self._done.wait(period_s):
            now = self._recorder.stats()
            line = self._describe(before, now)
            click.echo(line if self._plain else f"\r\x1b[K{line}", err=True, nl=self._plain)
            before = now
        if not self._plain:
            click.echo("\r\x1b[K", err=True, nl=False)

    def _describe(self, before: "RecorderStats", now: "RecorderStats") -> str:
        """Returns the progress in words; rates are per second of the source's time."""
        free = shutil.disk_usage(self._folder).free
        seconds, grown = now.seconds - before.seconds, now.size_bytes - before.size_bytes
        per_second = 1.0 / seconds if seconds else 0.0
        parts = [
            f"{now.seconds:.0f} s",
            f"{(now.events - before.events) * per_second:,.0f} events/s",
            f"{(now.frames - before.frames) * per_second:.0f} frames/s",
            f"{now.lost_before + now.lost_here:,} events lost",
            f"{now.size_bytes / 1e6:,.0f} MB",
            f"{free / 1e9:,.1f} GB free",
        ]
        if not seconds:
            parts.append("WARNING no data from the source")
        elif grown:
            parts.append(f"room for {free / grown * seconds / 60:,.0f} min")
        return ", ".join(parts)
