"""Prints sentences, and speaks them if the person wants speech."""

from neurotouch_hid.cli.ui.output import echo
from neurotouch_hid.closing import Closing
from neurotouch_hid.monitor import Cue, CueKind, Speaker
from neurotouch_hid.profile.schema import Feedback


class Voice(Closing):
    """Prints and speaks sentences; with tones, it plays one for accepted and one for rejected.

    A context manager.

    Args:
        feedback: the person's choice of sound, and its volume.
        err: write to the standard error.
    """

    def __init__(self, feedback: Feedback, *, err: bool = False) -> None:
        self._sound, self._volume = feedback.sound, feedback.volume
        self._err = err
        self._speaker = Speaker(lambda sentence: echo(sentence, err=True))

    def say(self, sentence: str) -> None:
        """Prints and speaks it, without a tone."""
        echo(sentence, err=self._err)
        if self._sound == "speech":
            self._speaker.play(Cue(CueKind.LAYER, sentence), "speech", self._volume.layer)

    def accept(self, sentence: str) -> None:
        """Reports that a movement counts."""
        echo(sentence, err=self._err)
        volume = self._volume.layer if self._volume.accept is None else self._volume.accept
        self._speaker.play(Cue(CueKind.ACCEPT, sentence), self._sound, volume)

    def reject(self, sentence: str) -> None:
        """Reports that a movement does not count."""
        echo(sentence, err=self._err)
        self._speaker.play(Cue(CueKind.REJECT, sentence), self._sound, self._volume.reject)

    def close(self) -> None:
        """Ends what still sounds."""
        self._speaker.close()
