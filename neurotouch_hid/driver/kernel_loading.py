"""Loads the kernels before a gamepad appears."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import islice
from threading import Timer
from typing import Final

from neurotouch_hid.driver.options import DriverOptions
from neurotouch_hid.geometry import Gel
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.process.kernel_cache import find_cache_trouble
from neurotouch_hid.profile import Profile
from neurotouch_hid.runtime import Pipeline, warm_up
from neurotouch_hid.source import open_source
from neurotouch_hid.vocabulary import SourceKind, find_source_kind

_PATIENCE_S: Final = 1.0
"""After this time of loading the person is told why."""
_WARM_SLICES: Final = 5
"""Slices of the simulator up to its first frame."""

_loaded: Final[set[tuple[str, Gel]]] = set()
"""Methods and gels whose kernels this process has: an evaluation opens many drivers."""


def load_kernels(
    options: DriverOptions, profile: Profile, gel: Gel, announce: Callable[[str], object]
) -> None:
    """Loads or compiles the kernels, so that no first slice waits for them.

    Of the sources only the simulator has kernels of its own that a first slice needs.

    Args:
        options: of the driver; its method and source decide which kernels.
        profile: the profile at the start.
        gel: the gel.
        announce: is told when loading takes long, and when kernels cannot be kept.
    """
    text = "Loading (the first time compiles for this processor, half a minute) ..."
    with _notice(text, announce):
        if (options.method, gel) not in _loaded:
            config = GestureConfig(method=options.method)
            warm_up(Pipeline.build(profile, config, gel=gel), gel)
            _loaded.add((options.method, gel))
        if find_source_kind(options.source) is SourceKind.SIMULATION:
            with open_source(options.source, speed="max", gel=gel) as first_slices:
                for _ in islice(first_slices, _WARM_SLICES):
                    pass
    if trouble := find_cache_trouble():
        announce(f"Warning: {trouble}")


@contextmanager
def _notice(text: str, announce: Callable[[str], object]) -> Iterator[None]:
    timer = Timer(_PATIENCE_S, announce, (text,))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
