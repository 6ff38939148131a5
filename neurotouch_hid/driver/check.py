"""Refuses a driver that cannot run, before the libraries are loaded that it would run on."""

from neurotouch_hid.device import check_device, find_copilot
from neurotouch_hid.driver.chosen import load_chosen
from neurotouch_hid.driver.control_socket import refuse_second
from neurotouch_hid.driver.options import DriverOptions
from neurotouch_hid.driver.settings import load_driver_settings
from neurotouch_hid.players import find_runtime_folder


def check_start(options: DriverOptions) -> None:
    """Checks what can be known without opening anything: other drivers, names, values.

    Args:
        options: of the driver; its source has been checked.

    Raises:
        AlreadyRunningError: another driver of this player runs.
        ProfileError: the profile or the values cannot be used.
        DeviceError: the pad cannot be made, its model is unknown, or the co-pilot's device is not
            there.
    """
    if options.is_listening:
        refuse_second(find_runtime_folder(options.player))
    if options.personal:
        load_chosen(None, options.profile, options.player)
    if options.needs_device or options.identity:
        check_device(options.device, options.identity)
    check_copilot(options)


def check_copilot(options: DriverOptions) -> None:
    """Checks that the device is there that plays along.

    Raises:
        DeviceError: it is not there, or it could be several.
        ProfileError: the file with the driver's settings has mistakes.
    """
    wanted = options.copilot
    if options.wait or not options.is_listening or wanted == "":
        return
    wanted = wanted or load_driver_settings(options.player).copilot.device
    if wanted:
        find_copilot(wanted)
