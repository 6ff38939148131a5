"""A person who goes through ``hello``, and knows what is asked for."""

from abc import ABC, abstractmethod

from neurotouch_hid.doctor.hello.session import Session


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
