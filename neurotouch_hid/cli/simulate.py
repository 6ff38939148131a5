"""``neurotouch simulate``: writes a labelled data set like the paper's."""

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from neurotouch_hid.cli.ui.options import Finite, gel_option
from neurotouch_hid.cli.ui.output import echo
from neurotouch_hid.cli.ui.usage_errors import WrongUsage

if TYPE_CHECKING:
    from neurotouch_hid.driver.gel_file import ChosenGel
    from neurotouch_hid.source.simulator.dataset import KnownRig


def _read_nuisances(
    context: click.Context, _option: click.Parameter, texts: tuple[str, ...]
) -> dict[str, float]:
    from neurotouch_hid.source.simulator.nuisances import read_nuisances

    if "list" in texts:
        _list_nuisances()
        context.exit()
    return read_nuisances(texts) if texts else {}


def _read_rig(path: Path) -> "tuple[ChosenGel, KnownRig, dict[str, float]]":
    """Returns the gel, the rig and the nuisances of a rig that was met, and says what they are."""
    from neurotouch_hid.doctor.hello.rig_settings import load_rig
    from neurotouch_hid.source.simulator.dataset import KnownRig

    met = load_rig(path)
    what = "a SIMULATED rig" if met.settings.simulated else "a real rig"
    n_known, n = met.settings.count_measured()
    echo(f"Like {what}: {n_known} of {n} settings were measured, the others are as usual.")
    config = met.settings.configure(met.gel.gel)
    return met.gel, KnownRig(config, met.content), met.settings.list_nuisances()


def _list_nuisances() -> None:
    from neurotouch_hid.source.simulator.nuisances import MIXTURES, NUISANCES

    place = ""
    for nuisance in NUISANCES.values():
        if nuisance.place != place:
            place = nuisance.place
            echo(f"{place}:")
        strength = f"{nuisance.strength:g} {nuisance.unit}".strip()
        echo(f"  {nuisance.name:<14}{strength:<16}{nuisance.what}")
    echo("mixtures:")
    for name, parts in MIXTURES.items():
        echo(f"  {name:<14}{' '.join(f'{part}={strength:g}' for part, strength in parts.items())}")


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch simulate play --users 1 --minutes 1\n"
    "  neurotouch simulate paper-like              the paper's length: 5 users, 25 minutes\n"
    "  neurotouch simulate hard --elasticity both --minutes 8\n"
    "  neurotouch simulate room --nuisance mild --nuisance bump=3\n"
    "  neurotouch simulate frames --camera uvc --fps 60 --nuisance rolling --nuisance doubled\n"
    "  neurotouch simulate more --like camera.hello.zip --minutes 5\n"
    "  neurotouch simulate --nuisance list         all nuisances, with their usual strength"
)
@click.argument("out", type=click.Path(path_type=Path, file_okay=False))
@click.option("--users", type=click.IntRange(min=1), default=5, show_default=True)
@click.option(
    "--minutes",
    type=Finite(min=0.1),
    default=25.0,
    show_default=True,
    help="Length of all recordings together.",
)
@click.option(
    "--seed",
    type=click.IntRange(0),
    default=0,
    show_default=True,
    help="Another seed, other people.",
)
@click.option(
    "--elasticity",
    type=click.Choice(["half-space", "solid", "both"]),
    default="half-space",
    show_default=True,
    help="How the gel deforms: by closed forms, by finite elements, or half of the set each.",
)
@click.option(
    "--camera",
    type=click.Choice(["davis", "uvc"]),
    show_default="davis, or that of --like",
    help="A DAVIS-346 with events and frames, or a UVC camera with frames alone.",
)
@click.option(
    "--fps",
    type=Finite(min=20.0, max=500.0),
    help="Frames per second of the UVC camera, 125 if not given.",
)
@click.option(
    "--nuisance",
    "nuisances",
    multiple=True,
    metavar="NAME[=STRENGTH]",
    is_eager=True,
    callback=_read_nuisances,
    help="Something that makes recordings harder; repeatable. 'list' shows all.",
)
@click.option(
    "--like",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="A file of 'neurotouch hello': all recordings are like that camera and gel. The "
    "pushes begin with seven seconds of rest, so that hello can measure them.",
)
@gel_option
@click.option("--force", is_flag=True, help="Replace recordings that were made with other options.")
def command(
    out: Path,
    users: int,
    minutes: float,
    seed: int,
    elasticity: str,
    camera: str | None,
    fps: float | None,
    nuisances: dict[str, float],
    like: Path | None,
    gel: str | None,
    force: bool,
) -> None:
    """Write simulated recordings with labels into the folder OUT.

    One recording for each gel, user and gesture. Ctrl-C stops; the same command continues from
    there. A set that was made with other options is never replaced without --force.
    """
    from neurotouch_hid.cli.shared.command_line import make_command_line
    from neurotouch_hid.driver.gel_file import choose_gel
    from neurotouch_hid.source.simulator.dataset import Progress, write_dataset
    from neurotouch_hid.source.simulator.gel import ELASTICITIES
    from neurotouch_hid.source.simulator.nuisances import read_nuisances

    if camera == "uvc":
        nuisances = {**read_nuisances([f"uvc={fps:g}" if fps else "uvc"]), **nuisances}
    elif fps is not None:
        raise click.UsageError("--fps is for --camera uvc.")
    begun = time.monotonic()
    told = {"percent": -100}
    step = 1 if sys.stderr.isatty() else 10  # a log file needs fewer lines

    def tell(progress: Progress) -> None:
        percent = int(100 * (progress.n_done + progress.share) / progress.n_files)
        if percent >= told["percent"] + step:
            told["percent"] = percent
            spent = time.monotonic() - begun
            echo(f"{percent:3d} %  {progress.path.name}  {spent:.0f} s", err=True)

    chosen, rig = choose_gel(gel, "sim:"), None
    if like is not None:
        if camera is not None or gel is not None:
            raise WrongUsage(
                "Option --like brings its own camera and gel.", hint="Leave out --camera and --gel."
            )
        chosen, rig, more = _read_rig(like)
        nuisances = {**more, **nuisances}
    gels = [name for name in ELASTICITIES if elasticity in (name, "both")]
    paths = write_dataset(
        out,
        users,
        minutes,
        seed,
        tell,
        gels,
        nuisances=nuisances,
        replace=force,
        command=make_command_line(),
        gel=chosen.gel,
        gel_file=chosen.file,
        rig=rig,
    )
    size_mb = sum(path.stat().st_size for path in paths) / 1e6
    echo(f"{len(paths)} SIMULATED recordings with labels, {size_mb:.0f} MB, are in {out}.")
    if nuisances:
        echo(f"Their nuisances: {', '.join(f'{n}={s:g}' for n, s in nuisances.items())}.")
