"""Plays sounds and speech through the programs of the desktop."""

import os
import shutil
import signal
import subprocess
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

from neurotouch_hid.monitor.cue import Cue
from neurotouch_hid.monitor.tone import make_wave
from neurotouch_hid.profile.schema import SoundName

SOUND_PROGRAMS: Final[dict[SoundName, tuple[tuple[str, ...], ...]]] = {
    "tones": (
        ("pw-play", "/dev/stdin"),
        ("paplay", "/dev/stdin", "--latency-msec=50"),
        ("aplay", "-q", "/dev/stdin"),
    ),
    "speech": (("spd-say", "--application-name=neurotouch", "--priority=text"),),
}
"""The programs in the order in which they are tried: PipeWire, PulseAudio, ALSA;
speech-dispatcher, with volumes from -100 to 100, where a new text interrupts the one before.
Without ``--latency-msec`` paplay fills a buffer of two seconds, and ends only after it is played.
"""

PATIENCE_S: Final[dict[SoundName, float]] = {"tones": 1.5, "speech": 5.0}
"""Time for a program to end: three times the longest tone; the first word starts the speech server.
"""

_MISSING: Final[dict[SoundName, str]] = {
    "tones": "no sound: none of pw-play, paplay and aplay is installed",
    "speech": "no speech: spd-say is not installed (the package speech-dispatcher)",
}


@dataclass(frozen=True, slots=True)
class PlaybackResult:
    """Result of playing a cue: True if the program reported success, and a sentence."""

    played: bool
    sentence: str


def play_cue(cue: Cue, mode: SoundName, volume: int) -> PlaybackResult:
    """Plays or speaks a cue with the first program that can; returns when it ends.

    Args:
        cue: what to play.
        mode: ``tones`` or ``speech``.
        volume: 1 to 100 percent.
    """
    content = make_wave(cue.kind, volume) if mode == "tones" else b""
    failed = []
    for program, *arguments in SOUND_PROGRAMS[mode]:
        found = shutil.which(program)
        if found is None:
            continue
        spoken = [] if mode == "tones" else [f"--volume={2 * volume - 100}", "--", cue.words]
        fault = _run([found, *arguments, *spoken], content, PATIENCE_S[mode])
        if not fault:
            return PlaybackResult(True, f"{mode} through {program}")
        failed.append(f"{program} {fault}")
    return PlaybackResult(False, f"no {mode}: {', '.join(failed)}" if failed else _MISSING[mode])


def _run(command: Sequence[str], content: bytes, patience_s: float) -> str:
    """Runs a program to its end, or to a time limit; returns the fault, empty if there is none.

    The content is a file in memory as its standard input. The program can open it as /dev/stdin
    and seek in it, and writing it never blocks.
    """
    try:
        with os.fdopen(os.memfd_create("cue"), "w+b") as file:
            file.write(content)
            file.seek(0)
            process = subprocess.Popen(  # noqa: S603  (a program from PATH, words of a profile)
                command,
                stdin=file,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,  # Ctrl-C is for the driver
            )
    except OSError as error:
        return f"cannot be started ({error.strerror})"
    try:
        code = process.wait(patience_s)
    except subprocess.TimeoutExpired:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        return "does not end"
    return f"ended with code {code}" if code else ""
