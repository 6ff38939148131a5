"""Short tones, one pattern for each cue, as WAV files."""

import io
import wave
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.monitor.cue import CueKind

RATE_HZ: Final = 44_100
PEAK: Final = 0.5
"""Share of full scale at 100 %: a sine of a few hundred Hz is already piercing at this level."""
FADE_S: Final = 0.006
"""Rise and fall of a note; a sharp edge would click."""

Note = tuple[float, float]
"""Frequency in Hz, duration in s."""

PATTERNS: Final[dict[CueKind, tuple[Note, ...]]] = {
    CueKind.PRESS: ((880.0, 0.04),),
    CueKind.ACCEPT: ((784.0, 0.06), (1175.0, 0.08)),
    CueKind.STEP: ((784.0, 0.06),),
    CueKind.REJECT: ((196.0, 0.16),),
    CueKind.LAYER: ((587.0, 0.05), (587.0, 0.05), (740.0, 0.08)),
    CueKind.PAUSE: ((659.0, 0.12), (440.0, 0.18)),
    CueKind.RESUME: ((440.0, 0.12), (659.0, 0.18)),
    CueKind.PANIC: ((494.0, 0.1), (330.0, 0.1), (494.0, 0.1), (330.0, 0.2)),
    CueKind.LOST: ((523.0, 0.1), (392.0, 0.1), (262.0, 0.25)),
    CueKind.FOUND: ((262.0, 0.1), (392.0, 0.1), (523.0, 0.25)),
}
"""Number, direction and pitch of the notes differ. All are below 1.2 kHz, because age takes the
hearing of high notes first. Good news rises, bad news falls."""


@lru_cache(maxsize=32)
def make_wave(kind: CueKind, volume: int) -> bytes:
    """Returns a WAV file, 16 bit, mono.

    Args:
        kind: the pattern.
        volume: 0 to 100 percent.
    """
    notes = [_make_note(*note) for note in PATTERNS[kind]]
    samples = np.concatenate(notes) * (PEAK * volume / 100 * 32_767)
    file = io.BytesIO()
    with wave.open(file, "wb") as out:
        out.setnchannels(1)
        out.setsampwidth(2)
        out.setframerate(RATE_HZ)
        out.writeframes(samples.astype("<i2").tobytes())
    return file.getvalue()


def _make_note(frequency_hz: float, duration_s: float) -> NDArray[np.float64]:
    t_s = np.arange(round(duration_s * RATE_HZ)) / RATE_HZ
    edge = np.minimum(t_s, t_s[::-1]) / FADE_S
    return np.sin(2 * np.pi * frequency_hz * t_s) * np.minimum(edge, 1.0)
