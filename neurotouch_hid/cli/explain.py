"""``neurotouch explain``: explains the code of a fault."""

import click

from neurotouch_hid.cli.ui.completing import complete_code
from neurotouch_hid.cli.ui.output import echo, json_option, print_json


@click.command(
    epilog="\b\nExamples:\n  neurotouch explain NT203\n  neurotouch explain            all codes"
)
@click.argument("code", required=False, shell_complete=complete_code)
@json_option
def command(code: str | None, as_json: bool) -> None:
    """Explain the CODE of a fault and how to fix it; without one, list them all."""
    from neurotouch_hid.profile.diagnostics import CODES, explain

    if as_json:
        chosen = {code.upper(): explain(code)} if code is not None else CODES
        print_json([{"code": key, "title": e.title, "text": e.text} for key, e in chosen.items()])
    elif code is not None:
        explanation = explain(code)
        echo(f"{code.upper()}: {explanation.title}")
        echo(explanation.text)
    else:
        for key, explanation in CODES.items():
            echo(f"{key}: {explanation.title}")
