"""``neurotouch label``: labels a recording by hand, at a page."""

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import click

from neurotouch_hid.cli.ui.options import PlainName, gel_option
from neurotouch_hid.cli.ui.output import echo, json_option, print_json
from neurotouch_hid.cli.ui.usage_errors import WrongUsage

if TYPE_CHECKING:
    from neurotouch_hid.labelling.label_file import LabelFile
    from neurotouch_hid.labelling.look_through import Moments
    from neurotouch_hid.labelling.track import Track


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch label play.aedat4 --open           saves play.labels.csv\n"
    "  neurotouch label clip.mkv --as anna           saves clip.anna.labels.csv\n"
    "  neurotouch label clip.mkv --as ben --beside anna\n"
    "  neurotouch label clip.mkv --as ben --beside anna --agreement\n\n"
    "Every change is saved at once. Ctrl-C ends the page."
)
@click.argument(
    "recording",
    type=click.Path(path_type=Path, dir_okay=False, readable=False),
    metavar="FILE",
    required=True,
)
@click.option("--as", "labeller", type=PlainName(), help="Your name, if several people label.")
@click.option("--beside", type=PlainName(), help="Show the labels of this person beside yours.")
@click.option(
    "--agreement",
    is_flag=True,
    help="Print how far both agree (Cohen's kappa, contacts, intensity), and end.",
)
@gel_option
@click.option("--open", "open_browser", is_flag=True, help="Open the page in your browser.")
@click.option("--port", type=click.IntRange(0, 65535), help="Default: 7878, or any if it is taken.")
@json_option
def command(
    recording: Path,
    labeller: str | None,
    beside: str | None,
    agreement: bool,
    gel: str | None,
    open_browser: bool,
    port: int | None,
    as_json: bool,
) -> None:
    """Label the recording FILE by hand, at a page: types and contact points of each moment.

    The recogniser proposes; you look, correct and confirm. The page leads to the doubtful moments.
    It works by keyboard alone.
    """
    if agreement and beside is None:
        raise WrongUsage(
            "Option --agreement needs another person's labels.",
            hint="Add the person's name: --beside NAME.",
        )
    if as_json and not agreement:
        raise WrongUsage("Option --json needs --agreement.", hint="Add --agreement.")
    if beside is not None and beside == labeller:
        raise WrongUsage("Both are the same person.", hint="Name two people: --as and --beside.")
    from neurotouch_hid.labelling.label_file import LabelFile, find_label_file
    from neurotouch_hid.labelling.look_through import Pictures, look_through
    from neurotouch_hid.recording.check import check_recording

    check_recording(recording)
    mine, other = find_label_file(recording, labeller), None
    if beside is not None:
        other = find_label_file(recording, beside)
        _require(other, f"neurotouch label {shlex.quote(str(recording))} --as {beside}")
    if agreement:
        own = "" if labeller is None else f" --as {labeller}"
        _require(mine, f"neurotouch label {shlex.quote(str(recording))}{own}")
    with Pictures() as pictures:
        progress = _Progress(as_json=as_json)
        moments = look_through(recording, pictures, gel=gel, progress=progress)
        theirs = None if other is None else LabelFile(other, moments).read()
        file = LabelFile(mine, moments)
        if theirs is not None and agreement:
            _print_agreement(moments, file.read(), theirs, as_json=as_json)
        else:
            _serve(moments, file, recording, theirs, beside, port=port, open_browser=open_browser)


def _require(path: Path, command: str) -> None:
    from neurotouch_hid.errors import RecordingError

    if not path.exists():
        raise RecordingError(f"There is no file '{path}'.", hint=f"Make it: {command}")


class _Progress:
    """Says every ten seconds of a recording that they are done."""

    def __init__(self, *, as_json: bool) -> None:
        self._said_s, self._is_silent = 0.0, as_json

    def __call__(self, seconds: float) -> None:
        if seconds >= self._said_s + 10.0 and not self._is_silent:
            self._said_s = seconds
            echo(f"{seconds:.0f} s looked through", err=True)


def _serve(
    moments: "Moments",
    file: "LabelFile",
    recording: Path,
    theirs: "Track | None",
    beside: str | None,
    *,
    port: int | None,
    open_browser: bool,
) -> None:
    import os
    import sys

    from neurotouch_hid.labelling.host import PAGES, LabelHost
    from neurotouch_hid.page.address import Address
    from neurotouch_hid.page.guard import Guard, make_token
    from neurotouch_hid.page.server import EndBySignal, Server, open_sockets, run_until_signal

    host = LabelHost(moments, file, name=recording.name, other=theirs, other_name=beside or "")
    token = make_token()
    server = Server(Guard(token), open_sockets(None, port), host, pages=PAGES)
    address = Address(server.url, token, os.getpid(), may_edit=True)
    end = EndBySignal()
    echo(f"Label here: {address.link()}")
    echo(f"Each change is saved: {file.path}")
    sys.stdout.flush()
    if open_browser:
        from neurotouch_hid.cli.view import open_page

        open_page(address)
    run_until_signal(server, end)


def _print_agreement(moments: "Moments", mine: "Track", theirs: "Track", *, as_json: bool) -> None:
    from dataclasses import asdict

    from neurotouch_hid.errors import RecordingError
    from neurotouch_hid.labelling.agreement import find_differences, measure_agreement
    from neurotouch_hid.messages import GestureKind

    found = measure_agreement(mine, theirs, moments.px_per_mm)
    if found is None:
        raise RecordingError("No moment has labels of both.", hint="Label the same recording.")
    begin_us = int(moments.t_us[0])
    differences = [
        {
            "from_s": (int(moments.t_us[run.first]) - begin_us) / 1e6,
            "to_s": (int(moments.t_us[run.last]) - begin_us) / 1e6,
            "mine": GestureKind(run.kind).label,
            "theirs": GestureKind(int(theirs.kind[run.first])).label,
        }
        for run in find_differences(mine, theirs)
    ]
    if as_json:
        print_json({**asdict(found), "differences": differences})
        return
    kappa = "not defined, one type only" if found.kappa is None else f"{found.kappa:.3f}"
    echo(f"Kappa of the types: {kappa}, at {found.n_moments} moments")
    echo(f"Same type: {100 * found.same_type:.1f} %, same count: {100 * found.same_count:.1f} %")
    if found.contact_mm is not None:
        echo(f"Contacts: {found.contact_mm:.2f} mm apart")
    if found.intensity_mm is not None:
        echo(f"Intensity: {found.intensity_mm:.2f} mm apart")
    for each in differences:
        echo(f"{each['from_s']:.2f} to {each['to_s']:.2f} s: {each['mine']}, {each['theirs']}")
