"""Faults of a camera, injected at a chosen moment."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from neurotouch_hid.errors import SourceError


class Stage(StrEnum):
    """Stage of the host's work in which a fault happens."""

    PLUGGED = "plugged"
    """Standard requests: the host identifies the new device."""
    OPEN = "open"
    """Vendor requests that read: the driver asks for versions and sizes."""
    CONFIGURE = "configure"
    """Vendor requests that write, until the stream is stopped."""
    STREAM = "stream"
    """Bulk transfers with data."""
    PICTURE = "picture"
    """Pictures of a UVC camera, each made of several transfers."""
    STOP = "stop"
    """Vendor requests that write, starting with the first that switches something off."""


class FaultKind(StrEnum):
    """Kinds of faults. Those of the first group can happen to requests and transfers."""

    UNPLUG = "unplug"
    STALL = "stall"
    TIMEOUT = "timeout"
    """A request or a transfer that is never answered."""
    PROTOCOL = "protocol"
    """A transfer that ends with EPROTO, as on a bad cable."""
    SHORT = "short"
    """A request: only half the answer. A transfer: cut off between a row and its event."""

    LOST = "lost"
    """A transfer that does not even end when the host cancels it: Linux has lost it."""
    BABBLE = "babble"
    """More data than asked for: the transfer ends with EOVERFLOW and its data is lost."""
    ODD = "odd"
    """A transfer of an odd number of bytes; the other half of its last word comes in the next."""
    MISSING = "missing"
    """A transfer lacks its first byte: from there on, each word is made of halves of two."""
    GARBAGE = "garbage"
    """A transfer of random bytes."""
    STALE = "stale"
    """Words of an earlier run, with their late times, come first."""
    OVERFLOW = "overflow"
    """Events are lost in the camera for 10 ms a time, and counted there."""
    RANGE = "range"
    """Row and event words with addresses outside of the chip."""
    BACKWARD = "backward"
    """A time word that goes back."""
    UNKNOWN = "unknown"
    """Words that no document describes."""
    WRAP = "wrap"
    """The clock jumps over 2**31 µs, as after 36 minutes; wrap words announce it."""
    RESET = "reset"
    """The clock starts again at 0, in the middle of the data."""
    SILENCE = "silence"
    """No data for 100 ms each time, not even wrap words."""
    SUSPEND = "suspend"
    """The camera loses its power for a moment: all registers are as after being plugged in."""

    DROPPED = "dropped"
    """A picture that is never sent."""
    DOUBLED = "doubled"
    """A picture in whose place the one before it is sent again."""
    DAMAGED = "damaged"
    """A picture with noise in its middle, which a JPEG decoder cannot read."""
    ERROR = "error"
    """A picture that the camera itself calls faulty, by the error bit of its headers."""
    SLOW = "slow"
    """A picture that takes twice its time, as do all after it: the rate is half of the promise."""


_ANYWHERE = {
    FaultKind.UNPLUG,
    FaultKind.STALL,
    FaultKind.TIMEOUT,
    FaultKind.PROTOCOL,
    FaultKind.SHORT,
}
_OF_PICTURES = {
    FaultKind.DROPPED,
    FaultKind.DOUBLED,
    FaultKind.DAMAGED,
    FaultKind.ERROR,
    FaultKind.SLOW,
}
_AT_PICTURES = _OF_PICTURES | {FaultKind.UNPLUG, FaultKind.SILENCE}
_FORM = re.compile(r"(?P<kind>\w+)(@(?P<stage>\w+))?(\+(?P<after>\d+))?(x(?P<times>\d+))?")


@dataclass(frozen=True, slots=True)
class Fault:
    """One fault.

    Attributes:
        kind: the kind.
        stage: the stage.
        after: number of requests or transfers of the stage before it.
        times: number of them that it affects.
    """

    kind: FaultKind
    stage: Stage = Stage.STREAM
    after: int = 0
    times: int = 1

    def __post_init__(self) -> None:
        match self.stage:
            case Stage.PICTURE:
                happens = self.kind in _AT_PICTURES
            case Stage.STREAM:
                happens = self.kind not in _OF_PICTURES
            case _:
                happens = self.kind in _ANYWHERE
        if not happens:
            place = "pictures" if self.kind in _OF_PICTURES else "the stream"
            raise SourceError(f"The fault {self.kind} happens to {place}, not at {self.stage}.")

    @classmethod
    def parse(cls, text: str) -> "Fault":
        """Parses ``KIND[@STAGE][+AFTER][xTIMES]``, such as ``stall@configure+3``.

        Raises:
            SourceError: it is something else.
        """
        found = _FORM.fullmatch(text)
        kinds, stages = ", ".join(FaultKind), ", ".join(Stage)
        hint = f"Write KIND[@STAGE][+AFTER][xTIMES]; kinds: {kinds}; stages: {stages}."
        if not found:
            raise SourceError(f"'{text}' is not a fault.", hint=hint)
        try:
            kind = FaultKind(found["kind"])
            usual = Stage.PICTURE if kind in _OF_PICTURES else Stage.STREAM
            stage = Stage(found["stage"] or usual)
        except ValueError as error:
            raise SourceError(f"'{text}' is not a fault.", hint=hint) from error
        return cls(kind, stage, int(found["after"] or 0), int(found["times"] or 1))


class FaultError(Exception):
    """The current transfer ends in a fault; the transport passes the fault to the host."""

    def __init__(self, kind: FaultKind) -> None:
        super().__init__(kind)
        self.kind = kind


class Script:
    """Counts the host's requests and transfers, and decides which of them fail.

    Args:
        faults: in any order.
    """

    def __init__(self, faults: Sequence[Fault] = ()) -> None:
        self._faults = tuple(faults)
        self._seen = dict.fromkeys(Stage, 0)

    def has(self, kind: FaultKind) -> bool:
        """Returns True if a fault of this kind is in the list."""
        return any(fault.kind is kind for fault in self._faults)

    def strike(self, stage: Stage) -> FaultKind | None:
        """Counts one request or transfer; returns its fault, if any."""
        n = self._seen[stage]
        self._seen[stage] += 1
        for fault in self._faults:
            if fault.stage is stage and fault.after <= n < fault.after + fault.times:
                return fault.kind
        return None
