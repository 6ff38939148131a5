"""People who go through ``hello``: one knows what is asked for, one makes what a script says."""

from abc import ABC, abstractmethod
from collections.abc import Iterator

from neurotouch_hid.doctor.hello.session import Session
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import Step
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline
from neurotouch_hid.source.simulator import Simulator
from neurotouch_hid.source.simulator.config import SimulatorConfig
from neurotouch_hid.source.simulator.script import Script


class Attendant(ABC):
    """Answers as a keyboard does, once the session has seen a slice.

    Attributes:
        session: the session.
    """

    def __init__(self, monkeypatch) -> None:
        self.session = None

        def note(session, *slice_):
            self.session = session
            return take(session, *slice_)

        take = Session.take
        monkeypatch.setattr(Session, "take", note)
        monkeypatch.setattr("neurotouch_hid.cli.ui.keyboard.Keyboard", lambda: self)

    def poll(self) -> str | None:
        if self.session is None or self.session.prompt is None:
            return None
        return self.answer(self.session)

    @abstractmethod
    def answer(self, session: Session) -> str | None:
        """The line that is typed now; None for nothing."""


def play(
    script: Script, config: SimulatorConfig, nuisances: dict[str, float] | None = None
) -> Iterator[Step]:
    """Plays a script to a simulated rig."""
    pipeline = Pipeline.build(load_profile("default"), GestureConfig())
    with Simulator(script, config, nuisances=nuisances or {}, seed=3) as source:
        for packet in source:
            step = pipeline.advance(packet)
            yield step
            pipeline.finish(step)
