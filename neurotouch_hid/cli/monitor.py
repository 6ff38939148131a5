"""``neurotouch monitor``: the live view in the terminal."""

import click

from neurotouch_hid.cli.ui.options import Finite
from neurotouch_hid.cli.ui.output import echo, plain_option
from neurotouch_hid.printable import make_printable

PICTURE_HZ = 12
LOOK_S = 0.25
"""Interval at which it looks for a driver while none runs."""


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch monitor                   a picture that follows the hand\n"
    "  neurotouch monitor --plain           one line for each change, for screen readers\n"
    "  neurotouch monitor --json | jq .say\n\n"
    "Without a driver it waits until one starts. It ends with the driver, after --seconds or by\n"
    "Ctrl-C; the driver continues. The same as a page: neurotouch view"
)
@plain_option
@click.option("--json", "as_lines", is_flag=True, help="Print each state as one line of JSON.")
@click.option("--seconds", type=Finite(min=0.1), help="End after this many seconds.")
def command(plain: bool, as_lines: bool, seconds: float | None) -> None:
    """Show the running driver: gesture, pad, ignored gestures with the reason, times, health.

    Exit code 0 when the driver or the time ends, 8 if no driver started within --seconds, 130
    after Ctrl-C.
    """
    import json
    import select
    import shutil
    import time

    from neurotouch_hid.client import explain_absence
    from neurotouch_hid.driver_state import read_head
    from neurotouch_hid.errors import NotRunningError
    from neurotouch_hid.page.text_view import LineWriter, draw_picture
    from neurotouch_hid.subscriber import Subscriber

    end = float("inf") if seconds is None else time.monotonic() + seconds
    listener = Subscriber()
    listener.want(PICTURE_HZ)
    if listener.connect() is None:
        text = f"No driver is running; waiting for one (Ctrl-C stops). {explain_absence()}"
        echo(text, err=True)
    while (peer := listener.connect()) is None:
        if time.monotonic() >= end:
            raise NotRunningError("No driver has started.", hint=explain_absence())
        time.sleep(LOOK_S)
    writer = LineWriter()
    height = 0
    while (left_s := end - time.monotonic()) > 0.0 and listener.peer is not None:
        select.select([peer], [], [], min(left_s, 3600.0))
        state = listener.take()
        if state is None:
            continue
        head = read_head(state)
        if as_lines:
            echo(json.dumps(head, ensure_ascii=False))
        elif plain:
            for line in writer.write(head, time.monotonic()):
                echo(line)
        else:
            columns, rows = shutil.get_terminal_size()
            drawn = map(make_printable, draw_picture(head)[: rows - 1])
            lines = [line[: columns - 1] for line in drawn]
            lines += [""] * (height - len(lines))
            up = f"\x1b[{height}A" if height else ""
            height = len(lines)
            click.echo(up + "".join(f"\r{line}\x1b[K\n" for line in lines), nl=False)
    listener.close()
    if left_s > 0.0:
        echo("The driver has ended.", err=True)
