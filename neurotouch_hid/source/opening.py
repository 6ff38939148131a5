"""From a source's name on the command line to the source."""

from typing import Literal

from neurotouch_hid.errors import SourceError
from neurotouch_hid.source.pacing import PacedSource
from neurotouch_hid.source.protocol import Source

Speed = Literal["recorded", "max"]
FORMS = ("file:NAME.aedat4", "sim:NAME", "davis:")


def open_source(
    spec: str, *, slice_us: int = 10_000, speed: Speed = "recorded", seed: int = 0
) -> Source:
    """The source of a name.

    Args:
        spec: ``file:NAME.aedat4`` (or just the path), ``sim:NAME``, ``davis:``.
        slice_us: length of a slice of sensor time.
        speed: ``recorded`` plays no faster than it happened, ``max`` as fast as it is asked for.
        seed: of the simulator's chance; recordings have none.

    Raises:
        SourceError: there is no such source.
        RecordingError: the recording cannot be used.
    """
    kind, colon, rest = spec.partition(":")
    if not colon or kind not in {"file", "sim", "davis"}:
        if spec.endswith(".aedat4"):
            kind, rest = "file", spec
        else:
            raise SourceError(f"{spec!r} is not a source", hint=f"give one of {', '.join(FORMS)}")
    source = _open(kind, rest, slice_us, seed)
    return PacedSource(source) if speed == "recorded" else source


def _open(kind: str, rest: str, slice_us: int, seed: int) -> Source:
    # Imported here: a replay needs no simulator and its compiled kernels, and the other way round.
    if kind == "file":
        from neurotouch_hid.source.replay import Replay  # noqa: PLC0415

        if not rest:
            raise SourceError("file: needs the name of a recording", hint="file:NAME.aedat4")
        return Replay(rest, slice_us=slice_us)
    if kind == "sim":
        from neurotouch_hid.source.simulator import Simulator  # noqa: PLC0415
        from neurotouch_hid.source.simulator.scenes import (  # noqa: PLC0415
            find_scene,
            scene_config,
        )

        return Simulator(find_scene(rest), scene_config(rest), seed=seed, slice_us=slice_us)
    raise SourceError(
        "davis: (the camera itself) is not in this version yet",
        hint="play a recording with file:NAME.aedat4 or the simulator with sim:NAME",
    )
