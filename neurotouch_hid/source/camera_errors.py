"""The reasons for which a camera is waited for."""

from neurotouch_hid.errors import CameraError


class CameraAbsentError(CameraError):
    """No such camera is plugged in."""


class CameraGoneError(CameraError):
    """The camera has been unplugged, or switched off by Linux."""
