"""``neurotouch emulate``: plugs an emulated camera into this machine."""

from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from itertools import chain
from typing import TYPE_CHECKING

import click

from neurotouch_hid.cli.ui.options import seconds_option

if TYPE_CHECKING:
    from neurotouch_hid.messages import EventPacket

_POLL_S = 0.5


@click.command(
    epilog="\b\nExamples:\n"
    "  sudo modprobe vhci-hcd                           once, on Debian and most others\n"
    "  sudo neurotouch emulate                          then, elsewhere: neurotouch run\n"
    "  sudo neurotouch emulate --source file:play.aedat4 --serial 00000042 --usb2\n"
    "  sudo neurotouch emulate --fault stall@configure+3 --fault unplug@stream+1000\n\n"
    "Ctrl-C unplugs it. neurotouch emulate --list-faults lists the faults."
)
@click.option(
    "--source",
    default="sim:tour",
    show_default=True,
    help="What the camera sees: sim:NAME (with nuisances: sim:tour,bump=3,mild) or "
    "file:NAME.aedat4; again from the start when it ends.",
)
@click.option("--serial", default="00000001", show_default=True, help="Eight digits on real ones.")
@click.option("--usb2", is_flag=True, help="As on a USB 2 port.")
@click.option(
    "--fault",
    "faults",
    multiple=True,
    metavar="KIND[@STAGE][+AFTER][xTIMES]",
    help="A fault: kind, stage, requests or transfers before it, and how often; repeatable.",
)
@click.option("--list-faults", is_flag=True, help="Print the kinds and stages of faults.")
@seconds_option
def command(
    source: str,
    serial: str,
    usb2: bool,
    faults: tuple[str, ...],
    list_faults: bool,
    seconds: float | None,
) -> None:
    """Plug an emulated DAVIS-346 into this machine's kernel: every program sees a camera.

    It needs Linux, root and the module vhci-hcd; nothing else and no camera.
    """
    from neurotouch_devtools.emulator import Fault, FaultKind, Stage

    if list_faults:
        click.echo(f"Kinds: {', '.join(FaultKind)}.\nStages: {', '.join(Stage)}.")
        return
    chosen = [Fault.parse(text) for text in faults]

    import time

    from neurotouch_devtools.emulator import (
        CameraConfig,
        EmulatedCamera,
        Identity,
        Prefetch,
        UsbIp,
        find_port,
    )
    from neurotouch_hid.source import open_source

    find_port(super_speed=not usb2)  # before anything is compiled
    config = CameraConfig(identity=Identity(serial=serial, super_speed=not usb2))
    with ExitStack() as stack:
        packets = stack.enter_context(open_source(source, speed="max"))
        seen = iter(_repeat(packets))
        first = next(seen)  # the kernels are compiled before the camera is plugged in
        ahead = stack.enter_context(Prefetch(chain([first], seen)))
        camera = EmulatedCamera(ahead, config, chosen)
        cable = stack.enter_context(UsbIp(camera))
        click.echo(
            f"Camera {serial} is plugged in and sees {packets.name}; Ctrl-C unplugs it.", err=True
        )
        begun = time.monotonic()
        try:
            while not cable.wait(_POLL_S):
                if seconds is not None and time.monotonic() - begun >= seconds:
                    break
            else:
                click.echo("The camera was unplugged.", err=True)
        except KeyboardInterrupt:
            pass  # the way to end it
    if camera.n_dropped:
        click.echo(f"{camera.n_dropped} events were lost: the driver was too slow.", err=True)


def _repeat(packets: "Iterable[EventPacket]") -> "Iterator[EventPacket]":
    """Repeats the packets of a source, with times that continue."""
    from dataclasses import replace

    shift_us = 0
    while True:
        begin_us: int | None = None
        for packet in packets:
            if begin_us is None:
                begin_us = packet.t_begin_us
                shift_us -= begin_us
            events = packet.events.copy()
            events["t"] += shift_us
            frames = tuple(
                replace(
                    frame,
                    exposure_begin_us=frame.exposure_begin_us + shift_us,
                    exposure_end_us=frame.exposure_end_us + shift_us,
                )
                for frame in packet.frames
            )
            end_us = packet.t_end_us + shift_us
            yield replace(
                packet,
                t_begin_us=packet.t_begin_us + shift_us,
                t_end_us=end_us,
                events=events,
                frames=frames,
            )
        if begin_us is None:
            return
        shift_us = end_us
