"""``neurotouch service``: runs the driver as a service of systemd."""

from functools import partial
from typing import TYPE_CHECKING

import click

from neurotouch_hid.cli.ui.completing import complete_source
from neurotouch_hid.cli.ui.output import echo

if TYPE_CHECKING:
    from collections.abc import Iterable

    from neurotouch_hid.device import Device, ExtraDevice
    from neurotouch_hid.device.outputs.identity import PadKind
    from neurotouch_hid.device.outputs.rumble import HearRumble
    from neurotouch_hid.driver.systemd import ServiceManager


@click.command(
    epilog="\b\nExamples:\n"
    "  sudo systemctl start neurotouch          the usual way\n"
    "  neurotouch service --source sim:tour     try it without a camera\n"
    "  neurotouch service --compile             only compile for this processor\n\n"
    "Exit codes: 0 ended by a signal, 3 source, 6 a file of settings, 7 virtual gamepad, 8 no such "
    "player or no control socket, 75 another driver runs."
)
@click.option(
    "--source",
    shell_complete=complete_source,
    show_default="davis:, with the serial number in service.yaml",
    help="Source to use instead of the camera.",
)
@click.option("--compile", "only_compile", is_flag=True, help="Compile for this processor and end.")
def command(source: str | None, only_compile: bool) -> None:
    """Drive the gamepad as a service: it waits for the camera, and keeps the pad without it.

    The settings of the person at the machine apply. The person changes them with 'neurotouch
    calibrate', 'neurotouch profile' or the page. If no person is at the machine, or the person has
    no settings, those in /etc/neurotouch apply: service.yaml, user.yaml and profiles. The service
    of player 2 is neurotouch@2, with the folder /etc/neurotouch/player-2.
    """
    from neurotouch_hid.driver import Driver, DriverOptions
    from neurotouch_hid.driver.admission import find_seated_users
    from neurotouch_hid.driver.camera_watchdog import CameraWatchdog
    from neurotouch_hid.driver.people import People, find_people_folder
    from neurotouch_hid.driver.service_settings import (
        check_service_settings,
        load_service_settings,
    )
    from neurotouch_hid.driver.systemd import ServiceManager
    from neurotouch_hid.players import find_player
    from neurotouch_hid.process.signals import stop_on_signals

    manager = ServiceManager()
    choices = load_service_settings()
    check_service_settings(choices)
    options = DriverOptions(
        source=source or choices.source,
        profile=choices.profile,
        device=choices.device,
        identity=choices.identity,
        player=find_player(),
        wait=True,
    )
    driver = Driver(
        options,
        announce=partial(echo, err=True),
        make_device=partial(_make_pad, manager),
        guests=find_seated_users,
        people=People(find_people_folder(), options.player),
    )
    if only_compile:
        driver.compile()
        return
    manager.report_status("preparing the kernels")
    with driver:
        stop = stop_on_signals(driver.reload)
        manager.report_ready()
        manager.report_status(
            f"{driver.source.name} → {driver.device.name}. More: neurotouch status"
        )
        watchdog = CameraWatchdog(driver.source)

        def on_round() -> None:
            manager.report_alive()
            watchdog.check()

        driver.run(stop=stop, on_round=on_round)
        manager.report_stopping()


def _make_pad(
    manager: "ServiceManager",
    kind: "PadKind",
    extra_devices: "Iterable[ExtraDevice]",
    *,
    identity: str | None,
    player: int,
    hear_rumble: "HearRumble | None",
) -> "Device":
    """Yields the pad at rest, made through descriptors from systemd, or opened here.

    Opens a descriptor for every possible node: the service may lose the right to open more.

    Raises:
        DeviceError: the kernel's node cannot be used.
    """
    from neurotouch_hid.device import CompositeDevice, ExtraDevice
    from neurotouch_hid.device.outputs.identity import choose_identity
    from neurotouch_hid.device.outputs.uinput import open_uinput

    spare = [manager.take_descriptor("uinput") or open_uinput() for _ in ("pad", *ExtraDevice)]
    return CompositeDevice(
        extra_devices,
        kind=kind,
        identity=choose_identity(identity, kind),
        player=player,
        hear_rumble=hear_rumble,
        open_descriptor=lambda: spare.pop() if spare else open_uinput(),
    )
