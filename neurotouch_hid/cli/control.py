"""Commands to the running driver: pause, resume, panic, stop, reload."""

import click

from neurotouch_hid.cli.shared.send_without_click import send_command

_json = click.option("--json", "as_json", is_flag=True, help="Print the answer as JSON.")
_notify = click.option(
    "--notify", is_flag=True, help="Without a terminal, show a failure on the desktop."
)


@click.command(epilog="\b\nExamples:\n  neurotouch pause")
@_json
@_notify
def pause(as_json: bool, notify: bool) -> None:
    """Release everything and stop acting; tracking goes on.

    To continue: neurotouch resume. If the profile has a gesture for 'pause', it resumes too.
    """
    raise SystemExit(send_command("pause", as_json=as_json, on_desktop=notify))


@click.command(epilog="\b\nExamples:\n  neurotouch resume")
@_json
@_notify
def resume(as_json: bool, notify: bool) -> None:
    """Continue at the next gesture, after a pause or a panic.

    No gesture acts before the gel has been at rest.
    """
    raise SystemExit(send_command("resume", as_json=as_json, on_desktop=notify))


@click.command(epilog="\b\nExamples:\n  neurotouch panic")
@_json
@_notify
def panic(as_json: bool, notify: bool) -> None:
    """Release everything and stay released until you resume.

    Only 'neurotouch resume' or a new start of the driver ends this.
    """
    raise SystemExit(send_command("panic", as_json=as_json, on_desktop=notify))


@click.command(epilog="\b\nExamples:\n  neurotouch stop")
@_json
def stop(as_json: bool) -> None:
    """End the running driver; everything is released first. If none runs, nothing is to be done.

    The system's service ends with: sudo systemctl stop neurotouch. To release everything and
    continue later, use pause or panic. Exit code 8 if the driver has not ended after 10 s.
    """
    raise SystemExit(send_command("stop", as_json=as_json))


@click.command(epilog="\b\nExamples:\n  neurotouch reload")
@_json
def reload(as_json: bool) -> None:
    """Load the profile and your own values again, now.

    Saved changes take effect within one second anyway. A profile with errors changes nothing: the
    answer says why, and the exit code is 8.
    """
    raise SystemExit(send_command("reload", as_json=as_json))
