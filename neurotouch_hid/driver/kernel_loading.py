"""Loads the kernels before a gamepad appears."""

import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from itertools import islice
from threading import Timer
from typing import Final

from neurotouch_hid.driver.options import DriverOptions
from neurotouch_hid.geometry import Gel
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.process.kernel_cache import find_cache_trouble
from neurotouch_hid.process.own_pool import open_pool
from neurotouch_hid.profile import Profile
from neurotouch_hid.runtime import Pipeline, warm_up, warm_up_gestures
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
    text = "Loading (the first time compiles for this processor, half a minute or more) ..."
    with _notice(text, announce):
        if (options.method, gel) not in _loaded:
            config = GestureConfig(method=options.method)
            warm_up(Pipeline.build(profile, config, gel=gel), gel)
            _loaded.add((options.method, gel))
        _play_first_slices(options.source, gel)
    if trouble := find_cache_trouble():
        announce(f"Warning: {trouble}")


@contextmanager
def share_compiling(options: DriverOptions, gel: Gel) -> Iterator[None]:
    """Lets a process beside this one compile what comes last in ``load_kernels``.

    This process then finds it compiled, or compiles it itself. Code for another processor, which a
    package brings along, is made by one process alone: its bytes would depend on who is quicker.
    """
    with ExitStack() as beside:
        if "NUMBA_CPU_NAME" not in os.environ and (os.cpu_count() or 1) > 1:
            with suppress(OSError, ImportError):  # a machine on which no pool can be made
                pool = beside.enter_context(open_pool(1))
                pool.submit(_load_last_kernels, options, gel)
        yield


def _load_last_kernels(options: DriverOptions, gel: Gel) -> None:
    warm_up_gestures(GestureConfig(method=options.method), gel)
    _play_first_slices(options.source, gel)


def _play_first_slices(source: str, gel: Gel) -> None:
    """Plays the first slices of the simulator, if it is the source."""
    if find_source_kind(source) is SourceKind.SIMULATION:
        with open_source(source, speed="max", gel=gel) as slices:
            for _ in islice(slices, _WARM_SLICES):
                pass


@contextmanager
def _notice(text: str, announce: Callable[[str], object]) -> Iterator[None]:
    timer = Timer(_PATIENCE_S, announce, (text,))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
