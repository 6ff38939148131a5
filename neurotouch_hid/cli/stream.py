"""``neurotouch stream``: sends what the running driver sees to other programs."""

import shutil
import subprocess
import time
from typing import TYPE_CHECKING, Any, NoReturn

import click

from neurotouch_hid.cli.ui.options import Finite
from neurotouch_hid.cli.ui.output import echo
from neurotouch_hid.cli.ui.usage_errors import WrongUsage
from neurotouch_hid.errors import StreamError
from neurotouch_hid.subscriber import MOST_HZ

if TYPE_CHECKING:
    from neurotouch_hid.stream import Sender

ROS2: tuple[str, ...] = ("ros2", "run", "neurotouch_ros", "publish")


class StreamAddress(click.ParamType):  # type: ignore[type-arg]  # generic from click 8.5 on
    """The address of a stream."""

    name = "address"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Returns the address."""
        from neurotouch_hid.stream import read_address

        try:
            return read_address(value)
        except ValueError as error:
            raise WrongUsage(str(error), hint="See: neurotouch stream --help") from None


@click.command(
    epilog="\b\nExamples:\n"
    "  neurotouch stream osc://127.0.0.1:9000      Pure Data, Max, SuperCollider, TouchDesigner\n"
    "  neurotouch stream websocket                 Godot, Unity, a page: ws://127.0.0.1:8765\n"
    "  neurotouch stream lsl --markers             LabRecorder and other laboratory programs\n"
    "  neurotouch stream ros2                      the ROS 2 package of integrations/ros2\n\n"
    "It hears the running driver, also one that starts later. Ctrl-C ends the stream, not the\n"
    "driver. What is sent is described in docs/streams."
)
@click.argument("address", type=StreamAddress())
@click.option("--markers", is_flag=True, help="Send the displacement of each marker, too.")
@click.option(
    "--rate",
    "hz",
    type=click.IntRange(1, MOST_HZ),
    default=MOST_HZ,
    show_default=True,
    help="States a second.",
)
@click.option("--seconds", type=Finite(min=0.1), help="End after this many seconds.")
def command(address: Any, markers: bool, hz: int, seconds: float | None) -> None:
    """Send gesture, contacts, pad and markers to another program.

    ADDRESS is osc://HOST:PORT, websocket or websocket://HOST:PORT, lsl, or ros2. When the driver
    ends, all at rest is sent once.
    """
    from neurotouch_hid.stream import open_target

    if address.kind == "ros2":
        if hz != MOST_HZ or seconds is not None:
            raise WrongUsage(
                "The ROS 2 node has no --rate and no --seconds.",
                hint="Leave them out. Ctrl-C ends the node.",
            )
        _run_ros2(markers=markers)
    end_s = float("inf") if seconds is None else time.monotonic() + seconds
    with open_target(address, markers=markers) as target:
        echo(f"Streaming to {target.name}. Ctrl-C ends it.")
        _send_all(target, hz, end_s)


def _send_all(target: "Sender", hz: int, end_s: float) -> None:
    from neurotouch_hid.stream import Reading, read_states

    state = ""
    try:
        for reading in read_states(hz, end_s):
            target.send(reading)
            if (reading.state == "ended") != (state == "ended") or not state:
                echo("Waiting for a driver." if reading.state == "ended" else "A driver plays.")
            state = reading.state
    finally:
        target.send(Reading())  # nothing stays pressed in the other program


def _run_ros2(*, markers: bool) -> NoReturn:
    """Runs the node of our ROS 2 package, which needs the Python of ROS."""
    program = shutil.which(ROS2[0])
    if program is None:
        raise StreamError(
            "There is no ROS 2 here: the command 'ros2' is not found.",
            hint="Load it first: source /opt/ros/jazzy/setup.bash. Then build our package: "
            "integrations/ros2/README.md.",
        )
    arguments = ["--ros-args", "-p", f"markers:={str(markers).lower()}"]
    with subprocess.Popen([program, *ROS2[1:], *arguments]) as node:  # noqa: S603 - fixed words
        try:
            raise SystemExit(node.wait())
        except KeyboardInterrupt:  # a signal to us alone has not reached it
            node.terminate()
            raise
