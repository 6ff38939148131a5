"""Opens a source by its name on the command line."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from neurotouch_hid.geometry import PAPER_GEL, Gel
from neurotouch_hid.source.camera_source import MAX_DELAY_US
from neurotouch_hid.source.check import find_path, refuse_source
from neurotouch_hid.source.pacing import PacedSource
from neurotouch_hid.source.plugin import open_plugin
from neurotouch_hid.source.protocol import Source
from neurotouch_hid.source.slice_pacer import MOVING_US
from neurotouch_hid.vocabulary import SourceKind, Speed, find_source_kind, is_clip

if TYPE_CHECKING:
    from neurotouch_hid.source.camera_config import CameraConfig
    from neurotouch_hid.source.simulator.script import Play
    from neurotouch_hid.source.video.view_search import GelFinder

PAPER_US = 10_000
"""Slices of recordings and simulations [NT, "Results"], so that figures stay comparable."""
LIVE_US = 4_000
"""Slices of a camera at rest: an event waits until its slice ends, half a slice on average."""


def open_source(
    spec: str,
    *,
    slice_us: int | None = None,
    speed: Speed = "recorded",
    seed: int = 0,
    camera: "CameraConfig | None" = None,
    wait: bool = False,
    max_delay_us: int | None = None,
    repeats: bool = False,
    gel: Gel = PAPER_GEL,
    finder: "GelFinder | None" = None,
) -> Source:
    """Returns the source of a name.

    Args:
        spec: ``davis:`` (the first camera) or ``davis:SERIAL``, ``video:`` (the only video camera
            that shows a gel) or ``video:NAME``, ``events:`` (the only event camera of the extra) or
            ``events:SERIAL``, ``file:NAME.aedat4`` or a video clip,
            ``file:NAME.mkv``, ``.avi`` or ``.mp4`` (or just the path), ``sim:NAME``, ``driver:``
            (packets of the running driver), or ``KIND:REST`` of another package: its entry point
            KIND in ``neurotouch.sources`` is called as
            ``make(REST, slice_us=..., seed=...)``.
        slice_us: length of a slice of sensor time; without, ``LIVE_US`` of an event camera, and
            ``MOVING_US`` while the gel moves, what suits the rate of a video camera, and
            ``PAPER_US`` of anything else.
        speed: ``recorded`` plays no faster than it happened, ``max`` as fast as possible; ignored
            for a camera.
        seed: of the simulator's chance; recordings have none.
        camera: how a camera is set up.
        wait: a camera need not be there yet.
        max_delay_us: slices of a camera that wait longer to be taken are dropped;
            if None, a limit that suits the pipeline.
        repeats: a simulated scene starts again at its end, for ever.
        gel: the gel that is simulated, or in front of an event camera.
        finder: finds the gel in the pictures of a video; without, frames show whole pictures.

    Raises:
        SourceError: there is no such source.
        RecordingError: the recording cannot be used.
        CameraError: the camera cannot be used.
        DriverError: ``driver:`` was asked for, and none runs, or it refuses.
    """
    kind, rest = find_source_kind(spec), spec.partition(":")[2]
    if kind is SourceKind.DRIVER:
        from neurotouch_hid.source.running_driver import RunningDriver  # noqa: PLC0415

        if rest:
            raise refuse_source(spec)
        return RunningDriver()
    if kind is SourceKind.CAMERA:
        from neurotouch_hid.source.davis import DavisSource  # noqa: PLC0415

        return DavisSource(
            rest,
            None if camera is None else camera.davis,
            slice_us=slice_us or LIVE_US,
            part_us=None if slice_us else MOVING_US,
            wait=wait,
            max_delay_us=max_delay_us or MAX_DELAY_US,
        )
    if kind is SourceKind.VIDEO:
        from neurotouch_hid.source.video.live import VideoCameraSource  # noqa: PLC0415

        return VideoCameraSource(
            rest,
            None if camera is None else camera.video,
            finder=finder,
            slice_us=slice_us,
            wait=wait,
            max_delay_us=max_delay_us or MAX_DELAY_US,
        )
    if kind is SourceKind.EVENTS:
        from neurotouch_hid.source.events.source import EventCameraSource  # noqa: PLC0415

        return EventCameraSource(
            rest,
            None if camera is None else camera.events,
            gel=gel,
            slice_us=slice_us or LIVE_US,
            part_us=None if slice_us else MOVING_US,
            wait=wait,
            max_delay_us=max_delay_us or MAX_DELAY_US,
        )
    source = _open(kind, spec, slice_us or PAPER_US, seed, repeats, gel, finder)
    return PacedSource(source) if speed == "recorded" and not source.is_live else source


def _open(
    kind: SourceKind,
    spec: str,
    slice_us: int,
    seed: int,
    repeats: bool,
    gel: Gel,
    finder: "GelFinder | None",
) -> Source:
    # Imported here: a replay needs no simulator and its compiled kernels, and the other way round.
    if kind is SourceKind.RECORDING and is_clip(spec):
        from neurotouch_hid.source.video.clip import ClipReplay  # noqa: PLC0415

        return ClipReplay(find_path(spec), finder, slice_us=slice_us)
    if kind is SourceKind.RECORDING:
        from neurotouch_hid.source.replay import Replay  # noqa: PLC0415

        return Replay(find_path(spec), slice_us=slice_us, gel=gel)
    if kind is SourceKind.OTHER:
        return open_plugin(spec, slice_us, seed)
    from neurotouch_hid.source.simulator import Simulator  # noqa: PLC0415
    from neurotouch_hid.source.simulator.field_table import read_field_table  # noqa: PLC0415
    from neurotouch_hid.source.simulator.scenes import (  # noqa: PLC0415
        FIELD_ENDING,
        find_scene,
        read_simulation,
        scene_config,
    )

    name, nuisances = read_simulation(spec.partition(":")[2])
    play: Play
    if name.endswith(FIELD_ENDING):
        play = read_field_table(Path(name))
    else:
        scene = find_scene(name)
        play = replace(scene, endless=repeats or scene.endless)
    config = scene_config(name).show(gel)
    simulator = Simulator(play, config, nuisances=nuisances, seed=seed, slice_us=slice_us)
    if "uvc" not in nuisances and "strobe" not in nuisances:
        return simulator
    if "uvc" not in nuisances:
        from neurotouch_hid.source.strobe.config import StrobeConfig  # noqa: PLC0415
        from neurotouch_hid.source.strobe.source import StrobedSource  # noqa: PLC0415

        return StrobedSource(simulator, StrobeConfig(dark_us=round(1e3 * nuisances["strobe"])))
    from neurotouch_hid.source.video.simulated import SimulatedVideo  # noqa: PLC0415

    return SimulatedVideo(simulator, finder, slice_us)
