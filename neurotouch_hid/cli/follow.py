"""Opens a source for commands that follow its gestures without a pad."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

from neurotouch_hid.vocabulary import SourceKind, find_source_kind

if TYPE_CHECKING:
    from neurotouch_hid.messages import Step


def read_steps(
    source: str,
    speed: Literal["recorded", "max"] = "recorded",
    seed: int = 0,
    method: str = "neurotouch",
    *,
    profile: str = "default",
    seconds: float | None = None,
) -> Iterator["Step"]:
    """Gives the steps of a source, slice by slice, with the person's own values."""
    from neurotouch_hid.cli.play import announce
    from neurotouch_hid.driver import Driver, DriverOptions

    options = DriverOptions(
        source=source,
        profile=profile,
        device="memory",
        speed=speed,
        method=method,
        seed=seed,
        listens=False,
    )
    with Driver(options, announce=announce) as driver:
        yield from driver.steps(seconds=seconds)


def is_guided(source: str, speed: Literal["recorded", "max"]) -> bool:
    """True if a person moves now and can be asked; false of what has been recorded."""
    return speed == "recorded" and find_source_kind(source) is not SourceKind.RECORDING
