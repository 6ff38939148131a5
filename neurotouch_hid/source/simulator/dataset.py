"""Writes a set of labelled recordings like the paper's, which has not been published."""

import fcntl
import hashlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from neurotouch_hid import __version__
from neurotouch_hid.errors import RecordingError
from neurotouch_hid.files.small_file import read_text
from neurotouch_hid.geometry import PAPER_GEL, Gel
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.partial_file import remove_left, write_whole
from neurotouch_hid.recording import (
    ClipWriter,
    Picture,
    RecordingWriter,
    Simulation,
    labels_path,
    write_beside,
    write_gel,
    write_labels,
)
from neurotouch_hid.source.rig_file import describe_strobe, rig_path
from neurotouch_hid.source.simulator.config import SimulatorConfig
from neurotouch_hid.source.simulator.gel import Elasticity
from neurotouch_hid.source.simulator.script import PRESS_US, Script, Stroke
from neurotouch_hid.source.simulator.simulated_people import (
    SimulatedPerson,
    draw_stroke,
    meet_person,
)
from neurotouch_hid.source.simulator.simulator import Simulator
from neurotouch_hid.source.simulator.uvc import enlarge, enlarge_points
from neurotouch_hid.source.strobe.config import StrobeConfig

KINDS = tuple(GestureKind)[1:]
MODEL = 1  # raised when the simulator changes, so that old files are written again
REST_US = 600_000  # at the start of each recording, so that the gel can be found
LONG_REST_US = 7_000_000  # of a user's first one with a known rig: ``hello`` can measure it again
NONE_SHARE = 0.4  # [NT, figure of the labels]: 15,000 of 37,912 frames show no gesture
HIDDEN_US = 350_000  # of each attack and release, below what is labelled
MANIFEST = "dataset.json"
MAX_MANIFEST_BYTES = 4 << 20  # some 10,000 recordings
SLICE_US = 20_000


@dataclass(frozen=True, slots=True)
class Recipe:
    """Parameters of one recording; equal recipes give equal recordings.

    ``gel_file`` is the SHA-256 of the gel's file; empty for the gel of the paper. ``like`` is that
    of the settings of the rig; empty if each user has another rig.
    """

    model: int
    seed: int
    user: int
    gesture: str
    duration_us: int
    gel: Elasticity = "half-space"
    nuisances: Mapping[str, float] = field(default_factory=dict)
    gel_file: str = ""
    like: str = ""

    @property
    def name(self) -> str:
        """The recording's name without suffix."""
        name = f"user{self.user + 1}-{self.gesture}"
        return name if self.gel == "half-space" else f"{name}-{self.gel}"

    def describe(self) -> dict[str, Any]:
        """Returns the parameters for the manifest, without what is empty."""
        described = asdict(self)
        for key in ("nuisances", "gel_file", "like"):
            if not described[key]:
                del described[key]
        return described


class KnownRig(NamedTuple):
    """A rig that all people of a set use.

    Attributes:
        config: its settings, with its gel.
        content: the file that they come from.
    """

    config: SimulatorConfig
    content: bytes


@dataclass(frozen=True, slots=True)
class Progress:
    """Progress of the writing.

    Attributes:
        path: the recording that is being written or was found finished.
        n_done: recordings finished before it.
        n_files: recordings of the set.
        share: of this recording, 0..1.
    """

    path: Path
    n_done: int
    n_files: int
    share: float


def write_dataset(
    out_dir: Path | str,
    users: int = 5,
    minutes: float = 25.0,
    seed: int = 0,
    progress: Callable[[Progress], None] = lambda _: None,
    gels: Sequence[Elasticity] = ("half-space",),
    *,
    nuisances: Mapping[str, float] | None = None,
    replace: bool = False,
    command: str = "",
    gel: Gel = PAPER_GEL,
    gel_file: bytes = b"",
    rig: KnownRig | None = None,
) -> list[Path]:
    """Writes one recording per gel, user and gesture, with labels; finished ones are kept.

    ``dataset.json`` lists the recipe of each complete recording, so an interrupted run continues
    where it stopped, and nothing of the interrupted recording is left.

    Args:
        out_dir: made if missing.
        users: number of simulated people.
        minutes: length of the whole set.
        seed: another seed gives other people and other gestures.
        progress: called at the start, about once a simulated second, and at the end of each file.
        gels: models of the gel. Every one has people and gestures of its own.
        nuisances: strength of each nuisance in every recording, by its name.
        replace: also overwrite recordings that were made from other recipes.
        command: the command line, which the recordings name.
        gel: the dots.
        gel_file: content of its file, which is copied beside each recording; empty for the gel of
            the paper.
        rig: the rig of all recordings; None if each user has another one.

    Returns:
        The recordings, gels and users one after another.

    Raises:
        RecordingError: the folder or a file cannot be written, another program writes a set there,
            or the folder has recordings that were made from other recipes.
    """
    folder = Path(out_dir)
    like = "" if rig is None else _digest(rig.content)
    recipes = plan_dataset(users, minutes, seed, gels, nuisances, _digest(gel_file), like)
    suffix = _choose_suffix(nuisances or {}, rig)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RecordingError.of_writing(folder, error) from error
    with _lock(folder):
        begun = _read_begun(folder)
        finished = begun or {}
        paths = [folder / f"{recipe.name}{suffix}" for recipe in recipes]
        if not replace:
            _refuse_others(recipes, paths, begun)
        remove_left(folder)
        if begun is None:  # what is there from now on is ours, also if the first one is stopped
            _write_manifest(folder, finished)
        for i, (recipe, path) in enumerate(zip(recipes, paths, strict=True)):
            is_there = path.exists() and labels_path(path).exists()
            if not (is_there and finished.get(recipe.name) == recipe.describe()):
                if finished.pop(recipe.name, None) is not None:
                    _write_manifest(folder, finished)
                for share in _record(recipe, path, command, gel, gel_file, rig):
                    progress(Progress(path, i, len(paths), share))
                finished[recipe.name] = recipe.describe()
                _write_manifest(folder, finished)
            progress(Progress(path, i, len(paths), 1.0))
        return paths


@contextmanager
def _lock(folder: Path) -> Iterator[None]:
    """Keeps another process from writing a set into the folder meanwhile; leaves no file there.

    Raises:
        RecordingError: another process writes one.
    """
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except OSError as error:
        raise RecordingError.of_writing(folder, error) from error
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise RecordingError(
                f"Another program writes a data set into '{folder}' now.",
                hint="Wait until it has ended, or choose another folder.",
            ) from None
        except OSError:
            pass  # a file system that knows no locks
        yield
    finally:
        os.close(descriptor)


def plan_dataset(
    users: int,
    minutes: float,
    seed: int,
    gels: Sequence[Elasticity] = ("half-space",),
    nuisances: Mapping[str, float] | None = None,
    gel_file: str = "",
    like: str = "",
) -> list[Recipe]:
    """Returns the recipes of a set, gels and users one after another."""
    duration_us = round(minutes * 60e6 / (len(gels) * users * len(KINDS)))
    more = {KINDS[0]: LONG_REST_US} if like else {}
    return [
        Recipe(
            MODEL,
            seed,
            user,
            kind.label,
            duration_us + more.get(kind, 0),
            gel,
            dict(nuisances or {}),
            gel_file,
            like,
        )
        for gel in gels
        for user in range(users)
        for kind in KINDS
    ]


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest() if content else ""


def _choose_suffix(nuisances: Mapping[str, float], rig: KnownRig | None) -> str:
    """Returns the ending of the files: a camera without events gives video clips."""
    is_clip = "uvc" in nuisances or (rig is not None and rig.config.uvc is not None)
    return ".mkv" if is_clip else ".aedat4"


def simulate_recipe(recipe: Recipe, gel: Gel = PAPER_GEL, rig: KnownRig | None = None) -> Simulator:
    """Returns the simulation of a recording with the dots of a gel, or with a rig and its gel."""
    kind = GestureKind[recipe.gesture.upper()]
    apart = 0 if recipe.gel == "half-space" else 500
    person, config = meet_person(1000 * recipe.seed + recipe.user + apart)
    config = config.show(gel) if rig is None else rig.config
    config = replace(config, gel=replace(config.gel, elasticity=recipe.gel))
    size = config.gel.layout.rim_mm / PAPER_GEL.rim_mm
    person = replace(person, reach_mm=size * person.reach_mm)
    rng = np.random.default_rng((recipe.seed, recipe.user + apart, kind))
    rest_us = LONG_REST_US if recipe.like and kind is KINDS[0] else REST_US
    script = draw_script(recipe.name, kind, recipe.duration_us, person, rng, rest_us)
    own_seed = int(rng.integers(1 << 31))
    return Simulator(script, config, nuisances=recipe.nuisances, seed=own_seed, slice_us=SLICE_US)


def draw_script(
    name: str,
    kind: GestureKind,
    duration_us: int,
    person: SimulatedPerson,
    rng: np.random.Generator,
    rest_us: int = REST_US,
) -> Script:
    """Returns a script of one repeated gesture, with the paper's share of rest between.

    It begins with ``rest_us`` of rest. The last gesture may run over the end, as when a camera is
    switched off.
    """
    strokes = list[Stroke]()
    t_us = rest_us
    while t_us < duration_us:
        stroke = replace(draw_stroke(kind, rng, person), start_us=t_us)
        strokes.append(stroke)
        shown_us = stroke.attack_us + stroke.hold_us + stroke.release_us
        hidden_us = (
            PRESS_US + 4 * stroke.creep_us + HIDDEN_US
        )  # of the stroke, but too weak to be labelled
        pause_us = max(shown_us * NONE_SHARE / (1.0 - NONE_SHARE) - hidden_us, 60_000)
        t_us = stroke.end_us + int(pause_us * rng.uniform(0.5, 1.5))
    return Script(name, tuple(strokes), duration_us)


def _record(
    recipe: Recipe, path: Path, command: str, gel: Gel, gel_file: bytes, rig: KnownRig | None
) -> Iterator[float]:
    """Writes a recording, labels and gel; yields the share done, once a simulated second."""
    yield 0.0
    nuisances = (f"{name}={strength:g}" for name, strength in recipe.nuisances.items())
    like = [] if rig is None else ["like another rig"]
    source = ",".join([recipe.name, *nuisances, *like])
    mark = Simulation(f"neurotouch-hid {__version__}", source, command, recipe.seed)
    with simulate_recipe(recipe, gel, rig) as simulator:
        write = _write_clip if path.suffix == ".mkv" else _write_recording
        for t_us in write(simulator, path, mark):
            yield min(t_us / recipe.duration_us, 0.999)
        write_gel(path, gel_file)
        dark_ms = recipe.nuisances.get("strobe")
        strobed = b""  # a rig file of an older recording goes
        if dark_ms is not None:
            strobe = StrobeConfig(dark_us=round(1e3 * dark_ms))
            strobed = f"{describe_strobe(strobe)}\n".encode()
        write_beside(rig_path(path), strobed)


def _write_recording(simulator: Simulator, path: Path, mark: Simulation) -> Iterator[int]:
    """Writes events, frames and labels; yields the time once a simulated second."""
    truths = []
    with RecordingWriter(path, simulation=mark) as writer:
        for packet in simulator:
            writer.write(packet)
            truths += [simulator.truth(t_us) for t_us in simulator.find_labelled_times(packet)]
            if packet.t_end_us % 1_000_000 == 0:
                yield packet.t_end_us
        write_labels(labels_path(path), truths)


def _write_clip(simulator: Simulator, path: Path, mark: Simulation) -> Iterator[int]:
    """Writes a clip and its labels, in pixels of the clip and µs since its first picture."""
    truths, first_us = [], None
    with ClipWriter(path, simulation=mark) as writer:
        for packet in simulator:
            for frame in packet.frames:
                begin_us, end_us = frame.exposure_begin_us, frame.exposure_end_us
                writer.write(Picture(enlarge(frame.pixels), begin_us, end_us))
                first_us = frame.t_us if first_us is None else first_us
            for t_us in simulator.find_labelled_times(packet):
                truth, since_us = simulator.truth(t_us), t_us - (first_us or 0)
                contacts_px = enlarge_points(truth.contacts_px)
                truths.append(replace(truth, t_us=since_us, contacts_px=contacts_px))
            if packet.t_end_us % 1_000_000 == 0:
                yield packet.t_end_us
        write_labels(labels_path(path), truths)


def _refuse_others(
    recipes: Sequence[Recipe], paths: Sequence[Path], begun: Mapping[str, object] | None
) -> None:
    for recipe, path in zip(recipes, paths, strict=True):
        made_from = None if begun is None else begun.get(recipe.name)
        was_stopped = made_from is None and begun is not None
        if was_stopped or made_from == recipe.describe():
            continue
        # A clip and a recording of one name share their labels.
        there = next((each for each in (path, labels_path(path)) if each.exists()), None)
        if there is not None:
            seed = made_from.get("seed") if isinstance(made_from, dict) else None
            what = "of unknown origin" if seed is None else f"of another set (seed {seed})"
            raise RecordingError(
                f"'{there}' exists already, {what}; nothing was changed.",
                hint="Choose another folder, or --force to replace it.",
            )


def read_manifest(folder: Path) -> dict[str, object]:
    """Returns the recipe of each simulated recording in a folder; empty if none is known."""
    return _read_begun(folder) or {}


def _read_begun(folder: Path) -> dict[str, object] | None:
    """Returns the recipes of the set that was begun in a folder, so far; None without a set."""
    try:
        content = json.loads(read_text(folder / MANIFEST, MAX_MANIFEST_BYTES))
    except (OSError, ValueError, RecursionError):
        return None  # no set here yet, or one that nobody can trust
    return content if isinstance(content, dict) else None


def _write_manifest(folder: Path, finished: dict[str, object]) -> None:
    path = folder / MANIFEST
    try:
        write_whole(path, f"{json.dumps(finished, indent=1)}\n".encode())
    except OSError as error:
        raise RecordingError.of_writing(path, error) from error
