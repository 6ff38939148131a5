"""Opens and describes the source of a driver."""

from neurotouch_hid.client import is_service_running
from neurotouch_hid.driver.camera_settings import load_camera_config
from neurotouch_hid.driver.options import DriverOptions
from neurotouch_hid.errors import AlreadyRunningError, CameraError
from neurotouch_hid.geometry import Gel
from neurotouch_hid.source import Source, Troubled, open_source
from neurotouch_hid.tracker import GelFinder


def open_driver_source(options: DriverOptions, gel: Gel) -> Source:
    """Opens the source of the options; a simulation has this gel.

    Raises:
        AlreadyRunningError: the service has the camera.
        NeuroTouchError: as ``open_source``.
    """
    try:
        return open_source(
            options.source,
            slice_us=options.slice_us,
            speed=options.speed,
            seed=options.seed,
            camera=load_camera_config(options.player),
            wait=options.wait,
            gel=gel,
            finder=GelFinder(gel),
        )
    except CameraError as error:
        from neurotouch_hid.source.davis import find_cameras  # noqa: PLC0415

        if not (find_cameras() and is_service_running()):
            raise
        raise AlreadyRunningError(
            "The neurotouch service is already running, and it has the camera.",
            hint="See what it does: neurotouch status. To play without it: "
            "sudo systemctl stop neurotouch",
        ) from error


def describe_source(source: Source) -> str:
    """Returns the name of a source, how often it failed, and why nothing comes from it."""
    said = source.name
    if isinstance(source, Troubled):
        if source.n_restarts:
            said += f", restarts because its data made no sense: {source.n_restarts}"
        if source.trouble:
            said += f". {source.trouble}"
    return said
