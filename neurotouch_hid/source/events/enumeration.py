"""Lists the event cameras of this machine, and finds one by a name."""

from dataclasses import dataclass

from neurotouch_hid.errors import CameraError
from neurotouch_hid.source.camera_errors import CameraAbsentError
from neurotouch_hid.source.events.library import Library
from neurotouch_hid.source.events.models import MODELS, Model, find_model


@dataclass(frozen=True, slots=True)
class EventCameraInfo:
    """An event camera as the library lists it.

    Attributes:
        model: what it is.
        serial: its serial number; empty if it could not be read.
        connection: how it is plugged in.
        address: where.
        reason: why it cannot be opened, or an empty string.
    """

    model: Model
    serial: str
    connection: str
    address: str
    reason: str = ""

    @property
    def source(self) -> str:
        """Its name as a source."""
        return f"events:{self.serial or self.model.title}"

    def __str__(self) -> str:
        return f"{self.model.title} {self.serial}".rstrip()


def find_event_cameras(library: Library) -> tuple[EventCameraInfo, ...]:
    """Returns all cameras, by model and number; none where the USB cannot be asked.

    A camera that nobody uses is opened for a moment.
    """
    try:
        listed = library.list_devices()
    except RuntimeError:  # no USB at all
        return ()
    found = []
    for device in listed:
        model = find_model(device.name.value)
        if model is not None:
            reason = "" if device.error is None else _explain(device.error)
            connection = device.connection.value
            info = EventCameraInfo(model, device.serial or "", connection, device.address, reason)
            found.append(info)
    return tuple(sorted(found, key=lambda info: (MODELS.index(info.model), info.serial)))


def choose_event_camera(cameras: tuple[EventCameraInfo, ...], name: str) -> EventCameraInfo:
    """Returns the camera of a name.

    Args:
        cameras: those of this machine.
        name: a serial number, or a part of the model's name; empty for the only camera.

    Raises:
        CameraAbsentError: it fits none.
        CameraError: it fits several.
    """
    if not cameras:
        raise CameraAbsentError(
            "No event camera is plugged in.",
            hint="Plug it in. Without a camera: neurotouch demo, or the source sim:tour.",
        )
    fitting = [info for info in cameras if name and info.serial == name] or [
        info for info in cameras if name.lower() in info.model.title.lower()
    ]
    there = ", ".join(map(str, cameras))
    if not fitting:
        raise CameraAbsentError(f"No event camera is called '{name}'.", hint=f"There is: {there}")
    if len(fitting) > 1:
        raise CameraError(
            f"Several event cameras fit: {', '.join(map(str, fitting))}.",
            hint=f"Choose one, for example: --source {fitting[0].source}",
        )
    return fitting[0]


def _explain(error: str) -> str:
    """Returns the library's words for why a camera cannot be opened, in ours."""
    lower = error.lower()
    if "access" in lower or "permission" in lower:
        return "no right to read and write it"
    if "busy" in lower:
        return "in use by another program"
    return error
