"""Sentences that are written, and heard where the person wants to hear."""

from types import TracebackType
from typing import Self

from neurotouch_hid.cli.ui.output import echo
from neurotouch_hid.monitor import Cue, CueKind, Speaker
from neurotouch_hid.profile.schema.feedback import Feedback


class Voice:
    """Writes a sentence and speaks it; with tones, plays whether something was accepted.

    A context manager.

    Args:
        feedback: how the person wants it, and how loud.
        err: write to the standard error.
    """

    def __init__(self, feedback: Feedback, *, err: bool = False) -> None:
        self._sound, self._volume = feedback.sound, feedback.volume
        self._err = err
        self._speaker = Speaker(lambda sentence: echo(sentence, err=True))

    def say(self, sentence: str) -> None:
        """Writes and speaks it; without a tone."""
        echo(sentence, err=self._err)
        if self._sound == "speech":
            self._speaker.play(Cue(CueKind.LAYER, sentence), "speech", self._volume.layer)

    def accept(self, sentence: str) -> None:
        """Says that something counts."""
        echo(sentence, err=self._err)
        volume = self._volume.layer if self._volume.accept is None else self._volume.accept
        self._speaker.play(Cue(CueKind.ACCEPT, sentence), self._sound, volume)

    def reject(self, sentence: str) -> None:
        """Says that something does not count."""
        echo(sentence, err=self._err)
        self._speaker.play(Cue(CueKind.REJECT, sentence), self._sound, self._volume.reject)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._speaker.close()
