"""The people, files and callbacks around the pipeline of one driver."""

from collections.abc import Callable
from dataclasses import dataclass, field

from neurotouch_hid.driver.people import People
from neurotouch_hid.driver.settings import DriverSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class Surroundings:
    """The people, files and callbacks around the pipeline of one driver.

    Attributes:
        announce: is told sentences for the person; called from several threads.
        end: ends the driver; None if only systemd may.
        people: a service's settings of the people at the machine; None if only the files of this
            process's user count.
        default: a service's profile for a person who has chosen none.
        player: the player number; None means the one of the environment.
        settings: hotkeys, applications and co-pilot of this machine.
        seed: seed of the simulator, if that is the source.
        gel_file: content of the gel's file; empty for the gel of the paper.
    """

    announce: Callable[[str], object] = str  # says nothing
    end: Callable[[], object] | None = None
    people: People | None = None
    default: str | None = None
    player: int | None = None
    settings: DriverSettings = field(default_factory=DriverSettings)
    seed: int | None = None
    gel_file: bytes = b""

    @property
    def is_service(self) -> bool:
        """True for the driver of all people at the machine, which may not use their sessions."""
        return self.people is not None
