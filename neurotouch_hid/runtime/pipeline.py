"""The line: one packet in, one pad state out."""

from neurotouch_hid.geometry import Rig
from neurotouch_hid.gesture import GestureConfig, GestureRecognizer
from neurotouch_hid.messages import EventPacket, Step
from neurotouch_hid.profile import Mapping, Profile, UserSettings
from neurotouch_hid.runtime.stopwatch import Stopwatch
from neurotouch_hid.runtime.worker import InlineRest, RestExchange, ThreadedRest
from neurotouch_hid.tracker import MarkerTracker, RestDetector


class Pipeline:
    """Tracker, gesture and profile in a row, with rest detection beside them.

    Args:
        rest: answers which frames show the gel at rest.
        tracker: follows the markers.
        recognizer: reads the gesture from the markers.
        mapping: turns the gesture into a pad state.
    """

    def __init__(
        self,
        rest: RestExchange,
        tracker: MarkerTracker,
        recognizer: GestureRecognizer,
        mapping: Mapping,
    ) -> None:
        self.rest = rest
        self.tracker = tracker
        self.recognizer = recognizer
        self.mapping = mapping

    @classmethod
    def build(
        cls,
        profile: Profile,
        gesture: GestureConfig,
        *,
        user: UserSettings | None = None,
        rig: Rig | None = None,
        live: bool = False,
        stopwatch: Stopwatch | None = None,
    ) -> "Pipeline":
        """The shipped line.

        Args:
            profile: what the gestures mean.
            gesture: how they are recognised.
            user: the person's own values; a usual hand without.
            rig: known view of the sensor, if there is a rig file.
            live: detect rest in a thread beside the line. Otherwise it is done in the line itself,
                so that a recording gives the same Steps bit for bit at any speed.
            stopwatch: watches the stages, if somebody wants to know their times.
        """
        detector = RestDetector(rig=rig)
        rest: RestExchange = ThreadedRest(detector) if live else InlineRest(detector)
        line = cls(rest, MarkerTracker(), GestureRecognizer(gesture), Mapping(profile, user))
        if stopwatch is not None:
            line.rest = stopwatch.watch("rest", line.rest, "exchange")
            line.tracker = stopwatch.watch("tracker", line.tracker, "update")
            line.recognizer = stopwatch.watch("gesture", line.recognizer, "update")
            line.mapping = stopwatch.watch("profile", line.mapping, "update")
        return line

    def advance(self, packet: EventPacket) -> Step:
        """Takes one slice of sensor time through all stages."""
        rest = self.rest.exchange(packet)  # newest answer or None; never blocks
        if rest is not None:
            self.tracker.anchor(rest)
        markers = self.tracker.update(packet)
        gesture = self.recognizer.update(markers)
        pad = self.mapping.update(gesture)
        return Step(packet, rest, markers, gesture, pad)

    def close(self) -> None:
        """Ends the thread of the rest detection, if there is one."""
        self.rest.close()
