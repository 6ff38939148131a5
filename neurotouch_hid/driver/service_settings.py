"""An administrator's choices for the service: the file ``/etc/neurotouch/service.yaml``."""

from pathlib import Path
from typing import Annotated, Final, Literal

from pydantic import Field

from neurotouch_hid.device.outputs.identity import choose_identity
from neurotouch_hid.errors import DeviceError, ProfileError
from neurotouch_hid.players import find_user_file
from neurotouch_hid.profile.reading import load_settings
from neurotouch_hid.profile.schema import SettingsFile, make_optional
from neurotouch_hid.vocabulary import NAME_PATTERN, SourceKind, find_source_kind

FILE: Final = "service.yaml"
_CAMERA: Final = r"^([A-Za-z0-9._-]{1,64}|video:[^\x00-\x1f\x7f]{0,128})$"


class ServiceSettings(SettingsFile):
    """The choices of the service; the values of the hand are beside it, in ``user.yaml``."""

    profile: Annotated[str, Field(pattern=NAME_PATTERN)] | None = Field(
        default=None,
        description="The profile at the start. Default: the first of the favourites, slots in "
        "user.yaml.",
        json_schema_extra=make_optional(),
    )
    camera: Annotated[str, Field(pattern=_CAMERA)] | None = Field(
        default=None,
        description="The serial number of the camera, as text in quotes, or video: with the place "
        "or name of a video camera; 'neurotouch devices' shows them. Default: the first DAVIS that "
        "is found.",
        json_schema_extra=make_optional(),
    )

    device: Literal["uinput", "hid"] = Field(
        default="uinput",
        description="How the pad is made: uinput, or hid for a true HID device, which needs "
        "/dev/uhid (see neurotouch-service(7)). Default: uinput.",
    )
    identity: Annotated[str, Field(min_length=1, max_length=256)] | None = Field(
        default=None,
        description="Controller model to emulate: the name of an identity, or the path of a file. "
        "Default: that of the kind of device.",
        json_schema_extra=make_optional(),
    )

    @property
    def source(self) -> str:
        """The source to open."""
        camera = self.camera or ""
        is_video = find_source_kind(camera) is SourceKind.VIDEO
        return camera if is_video else f"davis:{camera}"


def find_service_file() -> Path:
    """Returns the file of these choices; it need not exist."""
    return find_user_file().with_name(FILE)


def load_service_settings() -> ServiceSettings:
    """Returns the choices; the defaults if there is no file.

    Raises:
        ProfileError: the file says something we cannot do; every mistake has line and column.
    """
    return load_settings(find_service_file(), ServiceSettings)


def check_service_settings(choices: ServiceSettings) -> None:
    """Checks what only the pad's own modules can judge.

    Args:
        choices: what the file says.

    Raises:
        ProfileError: there is no such identity, or programs would misread it.
    """
    try:
        choose_identity(choices.identity, choices.device)
    except DeviceError as error:
        raise ProfileError(
            f"{find_service_file()}: identity: {error.message}", hint=error.hint
        ) from error
