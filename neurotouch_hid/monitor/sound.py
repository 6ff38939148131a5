"""Plays sounds for gestures, beside the pipeline."""

from collections.abc import Callable

from neurotouch_hid.messages import Step
from neurotouch_hid.monitor.cue import CueFinder, choose_volume, take_facts
from neurotouch_hid.monitor.speaker import Speaker
from neurotouch_hid.profile.schema import resolve_times
from neurotouch_hid.runtime import PipelineControl


class SoundMonitor:
    """A tap that plays the sounds that the person's ``feedback`` asks for.

    Args:
        control: the running driver, and the person's values that apply.
        announce: called once, in a thread, with a sentence for the person, if no sound is possible.
    """

    def __init__(self, control: PipelineControl, announce: Callable[[str], object]) -> None:
        self._control = control
        self._finder: CueFinder | None = CueFinder(take_facts(None, control.mapping))
        self._speaker = Speaker(announce)

    def __call__(self, step: Step) -> None:
        """Posts the sounds of ``step``; never waits."""
        mapping, user = self._control.mapping, self._control.user
        if user.feedback.sound == "none":
            self._finder = None
            return
        facts = take_facts(step, mapping)
        if self._finder is None:  # everything before this step is old
            self._finder = CueFinder(facts)
            return
        cues = self._finder.find(facts)
        if not cues:
            return
        waits = resolve_times(mapping.profile.timing, user.timing).accept_ms > 0
        for cue in cues:
            volume = choose_volume(cue.kind, user.feedback.volume, waits=waits)
            if volume:
                self._speaker.play(cue, user.feedback.sound, volume)
                return

    def describe(self) -> str:
        """Returns which sounds are played, or why none are."""
        sound = self._control.user.feedback.sound
        return self._speaker.sentence if sound != "none" and self._speaker.sentence else sound

    def close(self) -> None:
        """Ends its thread, after the present sound."""
        self._speaker.close()
