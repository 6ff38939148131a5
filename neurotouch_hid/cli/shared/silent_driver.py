"""Opens a source for commands that follow its gestures without a pad."""

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, Literal

from neurotouch_hid.cli.ui.output import echo
from neurotouch_hid.vocabulary import SourceKind, find_source_kind

if TYPE_CHECKING:
    from neurotouch_hid.driver import Driver
    from neurotouch_hid.messages import Step


def open_silent_driver(
    source: str,
    speed: Literal["recorded", "max"] = "recorded",
    seed: int = 0,
    method: str = "neurotouch",
    *,
    profile: str = "default",
) -> "Driver":
    """Returns a driver without a pad, with the person's own values; use it in a ``with`` block."""
    from neurotouch_hid.source.check import check_source

    check_source(source)
    from neurotouch_hid.driver import Driver, DriverOptions
    from neurotouch_hid.players import find_player

    options = DriverOptions(
        source=source,
        profile=profile,
        device="memory",
        player=find_player(),
        speed=speed,
        method=method,
        seed=seed,
        listens=False,
    )
    return Driver(options, announce=partial(echo, err=True))


def read_steps(source: str) -> Iterator["Step"]:
    """Yields the steps of a source, slice by slice, with the person's own values."""
    with open_silent_driver(source) as driver:
        yield from driver.steps()


def is_guided(source: str, speed: Literal["recorded", "max"]) -> bool:
    """Returns True if a person moves now and can follow instructions; a recording cannot."""
    return speed == "recorded" and find_source_kind(source) is not SourceKind.RECORDING
