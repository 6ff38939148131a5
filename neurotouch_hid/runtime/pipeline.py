"""The line: one packet in, one pad state out."""

from dataclasses import replace
from typing import Final

from neurotouch_hid.geometry import Rig
from neurotouch_hid.gesture import GestureConfig, GestureRecognizer
from neurotouch_hid.messages import EventPacket, GestureKind, RestField, Step
from neurotouch_hid.profile import Mapping, Profile, UserSettings
from neurotouch_hid.runtime.timing import Stopwatch
from neurotouch_hid.runtime.worker import FrameExchange, InlineRest, ThreadedRest
from neurotouch_hid.tracker import BlobFinder, MarkerTracker, RestDetector

IDLE_US: Final = 500_000
"""How long nothing must have been done before the line counts as idle."""
IDLE_FRAME_US: Final = 240_000
"""How often an idle line looks at a frame of a gel that was at rest in the one before."""


class Pipeline:
    """Tracker, gesture and profile in a row, with rest detection beside them.

    Args:
        rest: answers which frames show the gel at rest.
        tracker: follows the markers.
        recognizer: reads the gesture from the markers.
        mapping: turns the gesture into a pad state.
        live: frames are looked at beside the line, so that no pad state waits for them.
    """

    def __init__(
        self,
        rest: FrameExchange,
        tracker: MarkerTracker,
        recognizer: GestureRecognizer,
        mapping: Mapping,
        *,
        live: bool = False,
    ) -> None:
        self.rest = rest
        self.tracker = self._early = tracker
        self.recognizer = recognizer
        self.mapping = mapping
        self.is_live = live
        self._head: EventPacket | None = None
        self._anchor: RestField | None = None
        self._idle_us = self._looked_us = 0

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
            user: the person's own values, with their neutral pose; a usual hand without.
            rig: known view of the sensor, if there is a rig file.
            live: look at frames in a thread beside the line. Otherwise it is done in the line
                itself, so that a recording gives the same Steps bit for bit at any speed.
            stopwatch: watches the stages, if somebody wants to know their times.
        """
        if user is not None:
            gesture = replace(gesture, neutral=user.neutral)
        finder = BlobFinder()
        detector = RestDetector(rig=rig, finder=finder)
        rest: FrameExchange = ThreadedRest(detector, finder) if live else InlineRest(detector)
        tracker = MarkerTracker(finder=finder)  # of a live line it finds nothing itself
        line = cls(rest, tracker, GestureRecognizer(gesture), Mapping(profile, user), live=live)
        if stopwatch is not None:
            line.rest = stopwatch.watch("rest", line.rest, "exchange")
            line._early = stopwatch.watch("head", line.tracker, "update")
            line.tracker = stopwatch.watch("tracker", line.tracker, "update")
            line.tracker = stopwatch.watch("frames", line.tracker, "correct")
            line.recognizer = stopwatch.watch("gesture", line.recognizer, "update")
            line.mapping = stopwatch.watch("profile", line.mapping, "update")
        return line

    def advance_partial(self, packet: EventPacket) -> None:
        """Takes in the head of the next slice, of which less is left to do then; live only."""
        self._early.update(packet)
        self._head = packet

    def advance(self, packet: EventPacket) -> Step:
        """Takes one slice of sensor time through all stages; live, call ``process_frames`` then."""
        if self.is_live:
            markers = self.tracker.update(self._find_rest(packet))
        else:
            self._anchor = self._exchange(packet)
            markers = self.tracker.update(packet)
        gesture = self.recognizer.update(markers)
        pad = self.mapping.update(gesture)
        if "rezero" in pad.commands:
            self.recognizer.rezero()
        return Step(packet, self._anchor, markers, gesture, pad)

    @property
    def is_idle(self) -> bool:
        """Nothing has been done for a while; only a live line says so."""
        return self._idle_us >= IDLE_US

    @property
    def is_at_rest(self) -> bool:
        """It is idle, and the last frame that was looked at showed the gel at rest."""
        seen = self.rest.detector.stats()
        return self.is_idle and seen.n_rest > 0 and not seen.reason

    def process_frames(self, step: Step) -> None:
        """Hands over the frames of a slice that has gone through, and takes what others have shown.

        This may wait until the pad is written: it moves markers by tenths of a pixel, and knows
        where they were when the frame was exposed. Nothing is left to do if the line is not live.
        """
        if not self.is_live:
            return
        packet = step.packet
        if step.gesture.kind is GestureKind.NONE and step.pad.is_neutral:
            self._idle_us += packet.t_end_us - packet.t_begin_us
        else:
            self._idle_us = 0
        if packet.frames and self._may_skip(packet.frames[-1].t_us):
            packet = _without_frames(packet)
        self._anchor = self._exchange(packet)

    def _find_rest(self, packet: EventPacket) -> EventPacket:
        """What of a slice has not yet been taken in, without frames."""
        head, self._head = self._head, None
        if head is None or head.t_begin_us != packet.t_begin_us:
            return _without_frames(packet)
        events, gap = packet.events[len(head.events) :], packet.gap - head.gap
        return EventPacket(head.t_end_us, packet.t_end_us, events, (), gap)

    def _exchange(self, packet: EventPacket) -> RestField | None:
        sight = self.rest.exchange(packet)  # newest answer or None; never blocks
        if sight is None:
            return None
        if sight.rest is not None:
            self.tracker.anchor(sight.rest)
        if sight.searched is not None:
            self.tracker.correct(*sight.searched)
        return sight.rest

    def _may_skip(self, frame_us: int) -> bool:
        """True if a frame will tell nothing new: an idle gel that was at rest a moment ago."""
        if self.is_at_rest and 0 <= frame_us - self._looked_us < IDLE_FRAME_US:
            return True
        self._looked_us = frame_us
        return False

    def close(self) -> None:
        """Ends the thread of the rest detection, if there is one."""
        self.rest.close()


def _without_frames(packet: EventPacket) -> EventPacket:
    if not packet.frames:
        return packet
    return EventPacket(packet.t_begin_us, packet.t_end_us, packet.events, (), packet.gap)
