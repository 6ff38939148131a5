"""The nuisances of a real room: what each is, its unit, its usual strength, its function."""

import difflib
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Final

from neurotouch_hid.errors import SourceError
from neurotouch_hid.source.simulator.nuisances import (
    chip,
    dots,
    hand,
    light,
    marks,
    mount,
    optics,
    stream,
    uvc,
)
from neurotouch_hid.source.simulator.setup import Setup


@dataclass(frozen=True, slots=True)
class Nuisance:
    """One thing that makes a recording harder.

    Attributes:
        name: what a person writes.
        place: the part of the simulation that it changes.
        strength: its usual strength.
        unit: of the strength.
        least, most: limits of the strength.
        apply: returns a set-up with the nuisance in this strength. Its first sentence says what
            it is.
    """

    name: str
    place: str
    strength: float
    unit: str
    least: float
    most: float
    apply: Callable[[Setup, float], Setup]

    @property
    def what(self) -> str:
        """One sentence that says what it is; N is its strength."""
        sentence = (self.apply.__doc__ or "").strip().partition("\n")[0]
        return re.sub("``[a-z_]+``", "N", sentence)


_TABLE: Final = (
    # The camera comes first: others ask how often it sends frames.
    Nuisance("uvc", "camera", 125.0, "frames/s", 20.0, 500.0, uvc.uvc),
    Nuisance("rolling", "camera", 12.0, "ms", 0.0, 40.0, uvc.rolling),
    Nuisance("gamma", "camera", 2.2, "", 1.0, 3.0, uvc.gamma),
    Nuisance("mjpeg", "camera", 70.0, "", 1.0, 100.0, uvc.mjpeg),
    Nuisance("auto-exposure", "camera", 90.0, "DN", 10.0, 200.0, uvc.auto_exposure),
    # Hands come next: others ask when something happens in the script.
    Nuisance("tips", "hand", 4.0, "mm", 1.0, 12.0, hand.tips),
    Nuisance("gloves", "hand", 3.0, "mm", 0.0, 6.0, hand.gloves),
    Nuisance("taps", "hand", 60.0, "ms", 40.0, 1000.0, hand.taps),
    Nuisance("slow", "hand", 2.0, "mm/s", 0.5, 200.0, hand.slow),
    Nuisance("palm", "hand", 2.0, "mm", 0.1, 5.0, hand.palm),
    Nuisance("missing", "gel", 10.0, "%", 0.0, 60.0, dots.missing),
    Nuisance("faint", "gel", 10.0, "%", 0.0, 100.0, dots.faint),
    Nuisance("painted", "gel", 0.3, "mm", 0.0, 1.5, dots.painted),
    Nuisance("irregular", "gel", 30.0, "%", 0.0, 80.0, dots.irregular),
    Nuisance("dome", "gel", 100.0, "%", 0.0, 100.0, dots.dome),
    Nuisance("residue", "gel", 5.0, "%", 0.0, 20.0, dots.residue),
    Nuisance("bump", "mount", 2.0, "mm", 0.0, 10.0, mount.bump),
    Nuisance("creep", "mount", 3.0, "mm", 0.0, 10.0, mount.creep),
    Nuisance("turn", "mount", 3.0, "°", -45.0, 45.0, mount.turn),
    Nuisance("fan", "mount", 0.1, "mm", 0.0, 2.0, mount.fan),
    Nuisance("music", "mount", 0.1, "mm", 0.0, 2.0, mount.music),
    Nuisance("scale", "optics", 1.6, "px/mm", 1.4, 4.5, optics.scale),
    Nuisance("rotation", "optics", 20.0, "°", -180.0, 180.0, optics.rotation),
    Nuisance("decentring", "optics", 20.0, "px", -200.0, 200.0, optics.decentring),
    Nuisance("tilt", "optics", 10.0, "°", -30.0, 30.0, optics.tilt),
    Nuisance("fisheye", "optics", 90.0, "°", 1.0, 140.0, optics.fisheye),
    Nuisance("lens", "optics", -20.0, "%", -40.0, 40.0, optics.lens),
    Nuisance("blur", "optics", 1.5, "px", 0.0, 4.0, optics.blur),
    Nuisance("uneven", "light", 100.0, "%", 0.0, 160.0, light.uneven),
    Nuisance("vignetting", "light", 50.0, "%", 0.0, 90.0, light.vignetting),
    Nuisance("ring", "light", 30.0, "%", 0.0, 100.0, light.ring),
    Nuisance("pale", "light", 3.0, "times", 1.2, 15.0, light.pale),
    Nuisance("pwm", "light", 30.0, "%", 0.0, 200.0, light.pwm),
    Nuisance("pwm-fast", "light", 30.0, "%", 0.0, 200.0, light.pwm_fast),
    Nuisance("pwm-leak", "light", 6.0, "%", 0.0, 100.0, light.pwm_leak),
    Nuisance("mains", "light", 40.0, "%", 0.0, 200.0, light.mains),
    Nuisance("mains-leak", "light", 15.0, "%", 0.0, 100.0, light.mains_leak),
    Nuisance("strobe", "light", 1.5, "ms", 0.5, 5.0, light.strobe),
    Nuisance("lamp", "light", 30.0, "%", -90.0, 300.0, light.lamp),
    Nuisance("lamp-leak", "light", 15.0, "%", 0.0, 100.0, light.lamp_leak),
    Nuisance("sun", "light", 30.0, "%", 0.0, 100.0, light.sun),
    Nuisance("shadow", "light", 40.0, "%", 0.0, 95.0, light.shadow),
    Nuisance("glints", "picture", 12.0, "", 0.0, 60.0, marks.glints),
    Nuisance("dust", "picture", 30.0, "", 0.0, 500.0, marks.dust),
    Nuisance("gel-dust", "picture", 30.0, "", 0.0, 500.0, marks.gel_dust),
    Nuisance("fibres", "picture", 3.0, "", 0.0, 50.0, marks.fibres),
    Nuisance("gel-fibres", "picture", 8.0, "", 0.0, 50.0, marks.gel_fibres),
    Nuisance("scratches", "picture", 5.0, "", 0.0, 50.0, marks.scratches),
    Nuisance("edge", "picture", 15.0, "%", 0.0, 100.0, marks.edge),
    Nuisance("overexposed", "sensor", 3.0, "times", 1.0, 20.0, chip.overexposed),
    Nuisance("underexposed", "sensor", 8.0, "times", 1.0, 50.0, chip.underexposed),
    Nuisance("frame-noise", "sensor", 20.0, "DN", 0.0, 60.0, chip.frame_noise),
    Nuisance("hot", "sensor", 200.0, "pixels", 0.0, 5000.0, chip.hot),
    Nuisance("noise", "sensor", 15.0, "Hz", 0.0, 50.0, chip.noise),
    Nuisance("mismatch", "sensor", 0.08, "log units", 0.0, 0.2, chip.mismatch),
    Nuisance("threshold", "sensor", 0.4, "log units", 0.1, 0.8, chip.threshold),
    Nuisance("readout", "sensor", 1.0, "times", 0.0, 200.0, chip.readout),
    Nuisance("lost", "stream", 20.0, "ms", 0.0, 200.0, stream.lost),
    Nuisance("frames", "stream", 5.0, "frames/s", 0.0, 25.0, stream.frames),
    Nuisance("dropped", "stream", 5.0, "%", 0.0, 50.0, stream.dropped),
    Nuisance("doubled", "stream", 10.0, "%", 0.0, 50.0, stream.doubled),
    Nuisance("late", "stream", 30.0, "ms", 0.0, 200.0, stream.late),
    Nuisance("black", "stream", 20.0, "%", 0.0, 100.0, stream.black),
    Nuisance("hand-on", "clock", 0.5, "s", 0.0, 60.0, stream.hand_on),
    Nuisance("jump", "clock", 20.0, "s", 0.0, 100000.0, stream.jump),
    Nuisance("pause", "clock", 2.0, "s", 0.0, 60.0, stream.pause),
)

NUISANCES: Final = {nuisance.name: nuisance for nuisance in _TABLE}
"""All nuisances by name, in the order in which they are applied."""

MIXTURES: Final[Mapping[str, Mapping[str, float]]] = {
    "mild": {
        "missing": 2.0, "faint": 2.0, "painted": 0.1, "irregular": 10.0, "residue": 1.0,
        "bump": 0.3, "creep": 0.3, "turn": 0.5, "fan": 0.03,
        "rotation": 3.0, "decentring": 6.0, "tilt": 3.0, "lens": -3.0, "blur": 0.9,
        "uneven": 60.0, "mains": 5.0, "mains-leak": 1.0, "sun": 2.0, "shadow": 15.0,
        "glints": 3.0, "dust": 10.0, "gel-dust": 6.0, "fibres": 1.0, "scratches": 1.0, "edge": 5.0,
        "frame-noise": 4.0, "hot": 20.0, "noise": 3.0, "mismatch": 0.04, "readout": 1.0,
        "lost": 2.0,
    },
    "severe": {
        "missing": 10.0, "faint": 10.0, "painted": 0.3, "irregular": 30.0, "residue": 3.0,
        "bump": 1.5, "creep": 1.5, "turn": 2.0, "fan": 0.1,
        "rotation": 12.0, "decentring": 15.0, "tilt": 6.0, "lens": -8.0, "blur": 1.2,
        "uneven": 100.0, "mains": 20.0, "mains-leak": 4.0, "sun": 10.0, "shadow": 40.0,
        "glints": 8.0, "dust": 30.0, "gel-dust": 20.0, "fibres": 3.0, "gel-fibres": 3.0,
        "scratches": 3.0, "edge": 15.0,
        "frame-noise": 8.0, "hot": 100.0, "noise": 6.0, "mismatch": 0.06, "readout": 10.0,
        "lost": 10.0, "frames": 12.0, "black": 5.0,
    },
}  # fmt: skip
"""Many nuisances at once: a room as rooms are, and a bad one."""


def read_nuisances(texts: Iterable[str]) -> dict[str, float]:
    """Returns the strength of each nuisance that a person has written, by name.

    Args:
        texts: each is NAME, NAME=STRENGTH or the name of a mixture. A later one replaces the
            strength of an earlier one.

    Raises:
        SourceError: there is no such nuisance, or the strength is none.
    """
    strengths: dict[str, float] = {}
    for text in texts:
        name, equals, number = text.partition("=")
        if name in MIXTURES and not equals:
            strengths |= MIXTURES[name]
        else:
            nuisance = _find(name)
            strengths[name] = _read_strength(nuisance, number) if equals else nuisance.strength
    return strengths


def disturb(setup: Setup, strengths: Mapping[str, float]) -> Setup:
    """Returns a set-up with nuisances.

    Raises:
        SourceError: there is no such nuisance, or it does not fit the script.
    """
    for name in strengths:
        _find(name)
    for name, nuisance in NUISANCES.items():
        if name in strengths:
            setup = nuisance.apply(setup, strengths[name])
    return setup


def _find(name: str) -> Nuisance:
    if name in NUISANCES:
        return NUISANCES[name]
    close = difflib.get_close_matches(name.lower(), [*NUISANCES, *MIXTURES], 1)
    raise SourceError(
        f"There is no nuisance called '{name}'.",
        hint=f"Did you mean {close[0]}?" if close else "neurotouch simulate --nuisance list",
    )


def _read_strength(nuisance: Nuisance, text: str) -> float:
    try:
        strength = float(text)
    except ValueError:
        strength = float("nan")
    if nuisance.least <= strength <= nuisance.most:
        return strength
    raise SourceError(
        f"'{text}' is no strength of the nuisance {nuisance.name}.",
        hint=f"Give a number from {nuisance.least:g} to {nuisance.most:g} {nuisance.unit}".rstrip()
        + ".",
    )
