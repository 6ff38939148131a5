"""The models of event cameras that the library knows, and their configuration."""

import dataclasses
from typing import Any, Final, NamedTuple

from neurotouch_hid.errors import CameraError
from neurotouch_hid.source.events.config import EventsConfig
from neurotouch_hid.source.events.library import Library

LIMIT_PERIOD_US: Final = 200
"""Over which a camera counts its events for its limit; at most 1,023 [IMX636]."""
_BUFFER_BYTES: Final = 32_768
"""A full transfer; 0.5 ms at 20 million events/s. The library's 128 KiB would be 2 ms."""


class Region(NamedTuple):
    """A part of a sensor's picture, px; the ends are the first column and row after it."""

    x_begin: int
    y_begin: int
    x_end: int
    y_end: int


class Model(NamedTuple):
    """A model of event cameras.

    Attributes:
        key: the library's module for it, and its name in ``camera.yaml``.
        title: the library's name for it.
        width_px, height_px: size of its picture.
        has_mask: it can switch off rows and columns.
        has_limit: it can limit its events.
        is_networked: it is not at the USB.
    """

    key: str
    title: str
    width_px: int
    height_px: int
    has_mask: bool = False
    has_limit: bool = False
    is_networked: bool = False


MODELS: Final = (
    Model("prophesee_evk4", "Prophesee EVK4", 1280, 720, True, True),
    Model("prophesee_evk3_hd", "Prophesee EVK3 HD", 1280, 720, True, True),
    Model("centuryarks_vga", "CenturyArks VGA", 640, 480, True, True),
    Model("lucid_triton", "Lucid Triton", 1280, 720, is_networked=True),
    Model("inivation_dvxplorer", "iniVation DVXplorer", 640, 480),
    Model("inivation_davis346", "iniVation DAVIS 346", 346, 260),
)
"""As of neuromorphic-drivers 0.18. SilkyEvCam HD and IDS uEye XCP-E are of the kind EVK4."""
KEYS: Final = tuple(model.key for model in MODELS)
DAVIS: Final = MODELS[-1]


def find_model(title: str) -> Model | None:
    """Returns the model of the library's name for it; None for one that is not known."""
    return next((model for model in MODELS if model.title == title), None)


def make_configuration(
    library: Library, model: Model, config: EventsConfig, region: Region | None
) -> Any:
    """Returns the library's configuration of a camera.

    Args:
        library: the library.
        model: of the camera.
        config: the person's settings.
        region: the only part of the picture that is used; None for all of it.

    Raises:
        CameraError: a bias is unknown, or its value is impossible.
    """
    module = getattr(library, model.key)
    configuration = module.Configuration()
    _set_biases(configuration.biases, model, config)
    if region is not None and model.has_mask:
        mask = library.RowColumnMask(width=model.width_px, height=model.height_px, set=True)
        # The library counts the rows of a mask from below, those of events from above.
        mask.clear_rectangle(
            x=region.x_begin,
            y=model.height_px - region.y_end,
            width=region.x_end - region.x_begin,
            height=region.y_end - region.y_begin,
        )
        configuration.x_mask, configuration.y_mask = mask.x_mask(), mask.y_mask()
    if model.has_limit and config.max_events_per_s:
        configuration.rate_limiter = module.RateLimiter(
            reference_period_us=LIMIT_PERIOD_US,
            maximum_events_per_period=config.max_events_per_s * LIMIT_PERIOD_US // 1_000_000,
        )
    return configuration


def make_ring(library: Library, model: Model) -> Any:
    """Returns the library's configuration of its buffers; None for its own."""
    if model.is_networked:
        return None
    return getattr(library, model.key).RingConfiguration(buffer_length=_BUFFER_BYTES)


def _set_biases(biases: Any, model: Model, config: EventsConfig) -> None:
    known = [field.name for field in dataclasses.fields(biases)]
    for name, value in config.biases.get(model.key, {}).items():
        if name not in known:
            raise CameraError(
                f"The {model.title} has no bias '{name}'.",
                hint=f"In camera.yaml, events, biases, {model.key}: {', '.join(known)}.",
            )
        usual = getattr(biases, name)
        setattr(biases, name, bool(value) if isinstance(usual, bool) else value)
        try:
            biases.serialize()
        except (OverflowError, ValueError, TypeError) as error:
            raise CameraError(
                f"The bias {name} of the {model.title} cannot be {value}.",
                hint=f"Its usual value is {usual}.",
            ) from error
