"""``neurotouch emulate``: plugs an emulated camera into this machine."""

from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from itertools import chain
from typing import TYPE_CHECKING

import click

from neurotouch_hid.cli.ui.options import seconds_option

if TYPE_CHECKING:
    from neurotouch_devtools.emulator import CameraConfig, Fault
    from neurotouch_devtools.emulator.port import Camera
    from neurotouch_hid.messages import EventPacket

_POLL_S = 0.5


@click.command(
    epilog="\b\nExamples:\n"
    "  sudo modprobe vhci-hcd                           once, on Debian and most others\n"
    "  sudo neurotouch emulate                          then, elsewhere: neurotouch run\n"
    "  sudo neurotouch emulate --source file:play.aedat4 --serial 00000042 --usb2\n"
    "  sudo neurotouch emulate --chip 2 --colour 1      a smaller sensor, in colour\n"
    "  sudo neurotouch emulate --fault stall@configure+3 --fault unplug@stream+1000\n"
    "  sudo neurotouch emulate --camera uvc              then: neurotouch run --source video:\n"
    "  sudo neurotouch emulate --camera uvc --without gain --fault dropped+500x20\n\n"
    "Ctrl-C unplugs it. neurotouch emulate --list-faults lists the faults."
)
@click.option(
    "--camera",
    "kind",
    type=click.Choice(["davis", "uvc"]),
    default="davis",
    show_default=True,
    help="A DAVIS-346, or a webcam that takes up to 125 pictures a second.",
)
@click.option(
    "--source",
    default="sim:tour",
    show_default=True,
    help="What the camera sees: sim:NAME (with nuisances: sim:tour,bump=3,mild) or "
    "file:NAME.aedat4, which a webcam cannot show; again from the start when it ends.",
)
@click.option("--serial", default="00000001", show_default=True, help="Eight digits on real ones.")
@click.option("--usb2", is_flag=True, help="As on a USB 2 port.")
@click.option(
    "--chip",
    type=click.IntRange(0, 9),
    default=5,
    show_default=True,
    help="Sensor of the DAVIS: 4, 5 and 9 are DAVIS346, 0 to 2 DAVIS240.",
)
@click.option(
    "--colour",
    type=click.IntRange(0, 8),
    default=0,
    show_default=True,
    help="Colour filter of the DAVIS: 0 none, 1 to 4 with red, green and blue, 5 to 8 with white.",
)
@click.option(
    "--firmware", type=click.IntRange(0, 255), default=6, show_default=True, help="Of the DAVIS."
)
@click.option(
    "--fault",
    "faults",
    multiple=True,
    metavar="KIND[@STAGE][+AFTER][xTIMES]",
    help="A fault: kind, stage, what goes well before it, and how often; repeatable.",
)
@click.option(
    "--without",
    multiple=True,
    metavar="SETTING",
    help="A setting that the webcam has not, such as exposure, gain, focus; repeatable.",
)
@click.option("--list-faults", is_flag=True, help="Print the kinds and stages of faults.")
@seconds_option
def command(
    kind: str,
    source: str,
    serial: str,
    usb2: bool,
    chip: int,
    colour: int,
    firmware: int,
    faults: tuple[str, ...],
    without: tuple[str, ...],
    list_faults: bool,
    seconds: float | None,
) -> None:
    """Plug an emulated camera into this machine's kernel: every program sees a camera.

    It needs Linux, root and the module vhci-hcd; nothing else and no camera.
    """
    from neurotouch_devtools.emulator import Fault, FaultKind, Stage

    if list_faults:
        click.echo(f"Kinds: {', '.join(FaultKind)}.\nStages: {', '.join(Stage)}.")
        return
    chosen = [Fault.parse(text) for text in faults]
    if without and kind != "uvc":
        raise click.UsageError("Only a webcam can lack a setting: --camera uvc.")

    from neurotouch_devtools.emulator import CameraConfig, Identity, find_port

    find_port(super_speed=not usb2)  # before anything is compiled
    if kind == "uvc":
        _show_film(source, serial, without, chosen, super_speed=not usb2, seconds=seconds)
    else:
        identity = Identity(serial=serial, firmware=firmware, super_speed=not usb2)
        config = CameraConfig(identity=identity, chip=chip, colour=colour)
        _show_packets(source, config, chosen, seconds)


def _show_packets(
    source: str, config: "CameraConfig", faults: "list[Fault]", seconds: float | None
) -> None:
    """Plugs a DAVIS in."""
    from neurotouch_devtools.emulator import EmulatedCamera, Prefetch
    from neurotouch_hid.source import open_source

    with ExitStack() as stack:
        packets = stack.enter_context(open_source(source, speed="max"))
        seen = iter(_repeat(packets))
        first = next(seen)  # the kernels are compiled before the camera is plugged in
        ahead = stack.enter_context(Prefetch(chain([first], seen)))
        camera = EmulatedCamera(ahead, config, faults)
        _plug_in(
            camera,
            f"Camera {config.identity.serial} is plugged in and sees {packets.name}",
            seconds,
        )
    if camera.n_dropped:
        click.echo(f"{camera.n_dropped} events were lost: the driver was too slow.", err=True)


def _show_film(
    source: str,
    serial: str,
    without: tuple[str, ...],
    faults: "list[Fault]",
    *,
    super_speed: bool,
    seconds: float | None,
) -> None:
    """Plugs a UVC camera in."""
    from neurotouch_devtools.emulator.uvc import CONTROLS, UvcCamera, UvcConfig, UvcIdentity
    from neurotouch_hid.errors import SourceError

    if unknown := set(without) - set(CONTROLS):
        raise SourceError(
            f"'{min(unknown)}' is not a setting of a camera.",
            hint=f"Settings: {', '.join(CONTROLS)}.",
        )
    prefix, _, name = source.partition(":")
    if prefix != "sim":
        raise SourceError(
            f"A webcam cannot see '{source}'.", hint="Name a scene, for example sim:tour."
        )
    identity = UvcIdentity(serial=serial, super_speed=super_speed, without=frozenset(without))
    from neurotouch_devtools.emulator.uvc.filming import film_scene

    click.echo("Taking the pictures before they are shown; this can take a minute ...", err=True)
    camera = UvcCamera(film_scene(name), UvcConfig(identity), faults)
    _plug_in(camera, f"Webcam {serial} is plugged in and sees {source}", seconds)
    lost = f"; {camera.n_lost} were lost: the reader was too slow" if camera.n_lost else ""
    click.echo(f"{camera.n_sent} pictures were sent{lost}.", err=True)


def _plug_in(camera: "Camera", words: str, seconds: float | None) -> None:
    """Shows a camera to the kernel until it is unplugged, here or there, or time is up."""
    import time

    from neurotouch_devtools.emulator import UsbIp

    with UsbIp(camera) as cable:
        click.echo(f"{words}; Ctrl-C unplugs it.", err=True)
        begun = time.monotonic()
        try:
            while not cable.wait(_POLL_S):
                if seconds is not None and time.monotonic() - begun >= seconds:
                    break
            else:
                click.echo("The camera was unplugged.", err=True)
        except KeyboardInterrupt:
            pass  # the way to end it


def _repeat(packets: "Iterable[EventPacket]") -> "Iterator[EventPacket]":
    """Repeats the packets of a source, with times that continue."""
    from neurotouch_hid.events import shift_packet

    now_us = 0
    while True:
        shift_us: int | None = None
        for packet in packets:
            if shift_us is None:
                shift_us = now_us - packet.t_begin_us
            moved = shift_packet(packet, shift_us)
            now_us = moved.t_end_us
            yield moved
        if shift_us is None:
            return
