"""Plays sounds in a person's session for a driver that cannot: the service."""

from collections.abc import Callable

from neurotouch_hid.closing import Closing
from neurotouch_hid.driver_state import read_head, read_markers
from neurotouch_hid.monitor.cue import CueFacts, CueFinder, choose_volume
from neurotouch_hid.monitor.speaker import Speaker
from neurotouch_hid.profile.decision_log import MappingDecision
from neurotouch_hid.profile.schema import Feedback


class StreamSound(Closing):
    """Plays the cues of a driver's states.

    A driver sends only the newest state. A gesture that begins and ends between two states makes no
    sound for its press. Its effect makes a sound, because every state has the latest decisions.

    Args:
        announce: called once, in a thread, with a sentence for the person, if no sound is possible.

    Attributes:
        feedback: the sounds that the person wants.
    """

    def __init__(self, announce: Callable[[str], object]) -> None:
        self.feedback = Feedback()
        self._speaker = Speaker(announce)
        self._finder: CueFinder | None = None

    def hear(self, state: bytes) -> bool:
        """Posts the sounds of a state; never waits.

        Returns:
            False if the driver plays its sounds itself; then nothing is posted.
        """
        head = read_head(state)
        if head["slow"].get("plays_sound", True):
            return False
        gel = head["gel"]
        facts = CueFacts(
            head["state"],
            head["profile"],
            head["layer"],
            (gel["found"], gel["problem"]),
            lambda: gel["text"],
            float(read_markers(state)[1].mean()),
            head["gesture"]["kind"],
            tuple(MappingDecision(*action) for action in head["actions"]),  # type: ignore[arg-type]
        )
        if self._finder is None:  # everything before this state is old
            self._finder = CueFinder(facts)
            return True
        waits = head["slow"].get("accept_ms", 0.0) > 0
        for cue in self._finder.find(facts):
            volume = choose_volume(cue.kind, self.feedback.volume, waits=waits)
            if volume:
                self._speaker.play(cue, self.feedback.sound, volume)
                break
        return True

    def forget(self) -> None:
        """Starts again for another driver, or for the same one after a pause."""
        self._finder = None

    def close(self) -> None:
        """Ends its thread, after the present sound."""
        self._speaker.close()
