"""Lets the person hear what the gestures do, beside the pipeline."""

from collections.abc import Callable

from neurotouch_hid.messages import Step
from neurotouch_hid.monitor.cue import CueFinder, choose_volume, take_moment
from neurotouch_hid.monitor.speaker import Speaker
from neurotouch_hid.profile.schema.timing import resolve_times
from neurotouch_hid.runtime import PipelineControl


class SoundMonitor:
    """A tap that plays what the person's ``feedback`` asks for.

    Args:
        control: the running driver, and the person's values that apply.
        announce: tells the person a sentence, once, when no sound can be made; called in a thread.
    """

    def __init__(self, control: PipelineControl, announce: Callable[[str], object]) -> None:
        self._control = control
        self._finder = CueFinder(take_moment(None, control.mapping))
        self._speaker = Speaker(announce)

    def __call__(self, step: Step) -> None:
        """Posts what is to be heard of ``step``; never waits."""
        mapping, user = self._control.mapping, self._control.user
        cues = self._finder.find(take_moment(step, mapping))
        if not cues:
            return
        waits = resolve_times(mapping.profile.timing, user.timing).accept_ms > 0
        for cue in cues:
            volume = choose_volume(cue.kind, user.feedback.volume, waits=waits)
            if volume:
                self._speaker.play(cue, user.feedback.sound, volume)
                return

    def describe(self) -> str:
        """Returns what is heard, or why nothing is."""
        sound = self._control.user.feedback.sound
        return self._speaker.sentence if sound != "none" and self._speaker.sentence else sound

    def close(self) -> None:
        """Ends its thread; a sound that is being played may end first."""
        self._speaker.close()
