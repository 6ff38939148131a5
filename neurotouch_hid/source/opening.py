"""From a source's name on the command line to the source."""

from typing import TYPE_CHECKING, Literal

from neurotouch_hid.errors import PluginError, SourceError
from neurotouch_hid.plugins import SOURCES, list_plugins, load_plugin
from neurotouch_hid.source.pacing import PacedSource
from neurotouch_hid.source.protocol import Source

if TYPE_CHECKING:
    from neurotouch_hid.source.davis import DavisConfig

Speed = Literal["recorded", "max"]
PAPER_US = 10_000
"""Slices of recordings and simulations [NT, "Results"], so that figures stay comparable."""
LIVE_US = 4_000
"""Slices of a camera: an event waits for the end of its slice, for half of one on average."""
_MEMBERS = ("name", "rig", "is_live", "is_simulated", "__iter__", "close", "__enter__", "__exit__")
FORMS = ("davis:", "davis:SERIAL", "file:NAME.aedat4", "sim:NAME")


def open_source(
    spec: str,
    *,
    slice_us: int | None = None,
    speed: Speed = "recorded",
    seed: int = 0,
    camera: "DavisConfig | None" = None,
    wait: bool = False,
    max_delay_us: int | None = None,
) -> Source:
    """The source of a name.

    Args:
        spec: ``davis:`` (the first camera) or ``davis:SERIAL``, ``file:NAME.aedat4`` (or just the
            path), ``sim:NAME``, or ``KIND:REST`` of another package: its entry point KIND in
            ``neurotouch.sources`` is called as ``make(REST, slice_us=..., seed=...)``.
        slice_us: length of a slice of sensor time; without, ``LIVE_US`` of a camera and
            ``PAPER_US`` of anything else.
        speed: ``recorded`` plays no faster than it happened, ``max`` as fast as it is asked for; a
            camera has only its own.
        seed: of the simulator's chance; recordings have none.
        camera: how a camera is set up.
        wait: a camera need not be there yet.
        max_delay_us: slices of a camera that wait longer for whoever takes them are dropped;
            without, so long as suits the line.

    Raises:
        SourceError: there is no such source.
        RecordingError: the recording cannot be used.
        CameraError: the camera cannot be used.
    """
    kind, colon, rest = spec.partition(":")
    if not colon or kind not in {"file", "sim", "davis"}:
        if spec.endswith(".aedat4"):
            kind, rest = "file", spec
        else:
            return _open_plugin(spec, slice_us or PAPER_US, speed, seed)
    if kind == "davis":
        from neurotouch_hid.source.davis import MAX_DELAY_US, DavisSource  # noqa: PLC0415

        return DavisSource(
            rest,
            camera,
            slice_us=slice_us or LIVE_US,
            wait=wait,
            max_delay_us=max_delay_us or MAX_DELAY_US,
        )
    source = _open(kind, rest, slice_us or PAPER_US, seed)
    return PacedSource(source) if speed == "recorded" else source


def _open_plugin(spec: str, slice_us: int, speed: Speed, seed: int) -> Source:
    """Opens a source of another package, see ``plugins``."""
    kind, colon, rest = spec.partition(":")
    make = load_plugin(SOURCES, kind) if colon else None
    if make is None:
        forms = [*FORMS, *(f"{name}:" for name in list_plugins(SOURCES))]
        raise SourceError(f"{spec!r} is not a source", hint=f"give one of {', '.join(forms)}")
    source: Source = make(rest, slice_us=slice_us, seed=seed)
    missing = [each for each in _MEMBERS if not hasattr(source, each)]
    if missing:
        raise PluginError(
            f"The source '{kind}:' has no {', '.join(missing)}.",
            hint="It must be what neurotouch_hid.source.Source describes.",
        )
    return PacedSource(source) if speed == "recorded" and not source.is_live else source


def _open(kind: str, rest: str, slice_us: int, seed: int) -> Source:
    # Imported here: a replay needs no simulator and its compiled kernels, and the other way round.
    if kind == "file":
        from neurotouch_hid.source.replay import Replay  # noqa: PLC0415

        if not rest:
            raise SourceError("file: needs the name of a recording", hint="file:NAME.aedat4")
        return Replay(rest, slice_us=slice_us)
    from neurotouch_hid.source.simulator import Simulator  # noqa: PLC0415
    from neurotouch_hid.source.simulator.scenes import find_scene, scene_config  # noqa: PLC0415

    return Simulator(find_scene(rest), scene_config(rest), seed=seed, slice_us=slice_us)
