"""Lets a person hear a driver that cannot play sounds itself: the service, by its states."""

from collections.abc import Callable

from neurotouch_hid.closing import Closing
from neurotouch_hid.monitor.cue import CueFinder, Moment, choose_volume
from neurotouch_hid.monitor.speaker import Speaker
from neurotouch_hid.profile.decision_log import MappingDecision
from neurotouch_hid.profile.schema import Feedback
from neurotouch_hid.snapshot import read_head, read_markers


class StreamSound(Closing):
    """Plays the cues of a driver's states.

    A driver sends only the newest state. A gesture that begins and ends between two of them is not
    heard as a press. What it did is heard, for every state tells the latest decisions.

    Args:
        announce: tells the person a sentence, once, when no sound can be made; called in a thread.

    Attributes:
        feedback: what the person wants to hear.
    """

    def __init__(self, announce: Callable[[str], object]) -> None:
        self.feedback = Feedback()
        self._speaker = Speaker(announce)
        self._finder: CueFinder | None = None

    def hear(self, state: bytes) -> bool:
        """Posts what is to be heard of a state; never waits.

        Returns:
            False if the driver plays its sounds itself; then nothing is posted.
        """
        head = read_head(state)
        if head["slow"].get("plays_sound", True):
            return False
        moment = Moment(
            head["state"],
            head["profile"],
            head["layer"],
            int(read_markers(state)[1].sum()),
            head["gesture"]["kind"],
            tuple(MappingDecision(*action) for action in head["actions"]),  # type: ignore[arg-type]
        )
        if self._finder is None:  # whatever has happened before is old
            self._finder = CueFinder(moment)
            return True
        waits = head["slow"].get("accept_ms", 0.0) > 0
        for cue in self._finder.find(moment):
            volume = choose_volume(cue.kind, self.feedback.volume, waits=waits)
            if volume:
                self._speaker.play(cue, self.feedback.sound, volume)
                break
        return True

    def forget(self) -> None:
        """Begins again: another driver comes, or the same one after a while."""
        self._finder = None

    def close(self) -> None:
        """Ends its thread; a sound that is being played may end first."""
        self._speaker.close()
