"""``neurotouch gel check``: scores a gel that was made, and says what to change."""

from contextlib import ExitStack
from typing import TYPE_CHECKING, Any, Final

import click

from neurotouch_hid.cli.shared.telling import open_option, page_option, start_page
from neurotouch_hid.cli.ui.completing import complete_source
from neurotouch_hid.cli.ui.options import gel_option
from neurotouch_hid.cli.ui.output import echo, json_option, plain_option, print_json, show_finding
from neurotouch_hid.cli.ui.usage_errors import WrongUsage

if TYPE_CHECKING:
    from neurotouch_hid.doctor.gel_score import GelScore

_FIRST: Final = {"title": "Check a gel", "request": "The camera is being opened."}


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch gel check video:\n"
    "  neurotouch gel check video: --live          while you turn the lens\n"
    "  neurotouch gel check video: --live --open   the whole score, at a page\n"
    "  neurotouch gel check video: --gel try.yaml\n"
    "  neurotouch gel check sim:push\n"
    "  neurotouch gel check video: --json\n\n"
    "Exit code 0 if nothing failed, 1 otherwise. The driver must not use the camera meanwhile."
)
@click.argument("source", shell_complete=complete_source)
@click.option(
    "--live",
    is_flag=True,
    help="Print a line at each change while you turn the lens, at most twice a second, until "
    "Ctrl-C.",
)
@page_option
@open_option
@gel_option
@plain_option
@json_option
def command(
    source: str,
    live: bool,
    with_page: bool,
    open_browser: bool,
    gel: str | None,
    plain: bool,
    as_json: bool,
) -> None:
    """Look at the gel of SOURCE for five seconds, and compare it with its file.

    SOURCE is video: (a webcam), davis:, file:NAME (a recording) or sim:NAME. Leave the gel
    untouched. The picture with boxes around the dots is in your cache folder.
    """
    from neurotouch_hid.doctor.gel import GelView, examine_frames
    from neurotouch_hid.doctor.gel_score import score_gel
    from neurotouch_hid.driver.gel_file import find_gel_file, load_gel_file
    from neurotouch_hid.gel_making.plan import make_plan
    from neurotouch_hid.source.check import check_source

    check_source(source)
    if (with_page or open_browser) and not live:
        raise WrongUsage("The page shows a score while it changes.", hint="Add --live.")
    if live and as_json:
        raise WrongUsage(
            "Option --json prints one score, and --live lines for people.",
            hint="Leave one of them out.",
        )
    gel_file = load_gel_file(find_gel_file(gel, source))
    plan = make_plan(gel_file.settings, is_made=True)
    view = GelView(source=source, gel=gel)
    planned = "making" in gel_file.settings.model_fields_set
    if live:
        with ExitStack() as stack:
            page = None
            if with_page or open_browser:
                page = start_page(stack, [], open_browser=open_browser, **_FIRST)
            said = ""
            for seen in view.watch():
                now = examine_frames(seen.frames, plan.gel).state
                score = score_gel(seen, now, plan, planned=planned)
                if page is not None:
                    is_simulated = seen.source.startswith("SIMULATED")
                    page.show(simulated=is_simulated, **_describe(score))
                if score.line != said:
                    said = score.line
                    echo(said)
        return
    state = None if view.figures is None else view.figures.state
    score = score_gel(view.seen, state, plan, planned=planned)
    if as_json:
        print_json(score.as_json())
    else:
        for finding in score.findings:
            show_finding(finding, plain=plain)
        if view.seen is not None:
            echo(f"Compared with {gel_file.name}. {view.save_boxes()}")
    if not score.is_good:
        raise SystemExit(1)


def _describe(score: "GelScore") -> dict[str, Any]:
    """Returns a score for the page: what to change first, and all findings."""
    return {
        "request": score.advice or "All is in order.",
        "score": [
            {
                "word": str(each.status),
                "name": each.check,
                "sentence": each.sentence,
                "fix": each.fix,
            }
            for each in score.findings
        ],
    }
