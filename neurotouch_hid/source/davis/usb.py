"""Finds cameras and opens them with libusb1, or with pyusb where that cannot be loaded."""

from contextlib import suppress

from neurotouch_hid.errors import CameraBusyError
from neurotouch_hid.source.camera_source import PatientWatch, Watch
from neurotouch_hid.source.davis.enumeration import (
    CameraInfo,
    choose_camera,
    describe_users,
    find_cameras,
    find_users,
)
from neurotouch_hid.source.davis.transport import Transport


class Usb:
    """Finds and opens cameras on this machine."""

    def choose(self, serial: str) -> CameraInfo:
        """Returns the camera of a serial number, or the first one.

        Raises:
            CameraError: it is not plugged in.
        """
        return choose_camera(find_cameras(), serial)

    def open(self, info: CameraInfo) -> Transport:
        """Returns the open camera, claimed by this process.

        Raises:
            CameraBusyError: another program has it; names it.
            CameraError: it cannot be opened.
        """
        try:
            if _has_libusb1():
                from neurotouch_hid.source.davis.libusb import LibusbTransport  # noqa: PLC0415

                return LibusbTransport(info.bus, info.address)
            from neurotouch_hid.source.davis.pyusb import PyusbTransport  # noqa: PLC0415

            return PyusbTransport(info.bus, info.address)
        except CameraBusyError as error:
            raise CameraBusyError(
                f"The camera {info.serial} is in use by {describe_users(find_users(info))}.",
                hint="End that program first.",
            ) from error

    def watch(self) -> Watch:
        """Returns a watch that waits for cameras."""
        if _has_libusb1():
            import usb1  # noqa: PLC0415

            from neurotouch_hid.source.davis.libusb import LibusbWatch  # noqa: PLC0415

            with suppress(usb1.USBError):  # a libusb that cannot listen here
                return LibusbWatch()
        return PatientWatch()


def _has_libusb1() -> bool:
    try:
        import usb1  # noqa: PLC0415

        usb1.loadLibrary()
    except (ImportError, OSError):  # the package, or the library itself
        return False
    return True
