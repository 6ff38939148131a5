"""The pipeline: one packet in, one pad state out."""

from dataclasses import replace
from time import perf_counter_ns
from typing import Final

from neurotouch_hid.geometry import PAPER_GEL, Gel, Rig
from neurotouch_hid.gesture import GestureConfig, GestureRecognizer
from neurotouch_hid.messages import (
    EventPacket,
    GamepadState,
    GelProblem,
    GelState,
    Gesture,
    GestureKind,
    MarkerField,
    RestField,
    Step,
    no_gesture,
)
from neurotouch_hid.profile import Mapping, Profile, UserSettings
from neurotouch_hid.runtime.stage_timing import StageTimings
from neurotouch_hid.runtime.worker import FrameExchange, InlineRest, ThreadedRest
from neurotouch_hid.tracker import BlobFinder, Flicker, MarkerTracker, RestDetector

IDLE_US: Final = 500_000
"""The pipeline counts as idle after this time without a gesture."""
IDLE_FRAME_US: Final = 240_000
"""After a frame that showed the gel at rest, an idle pipeline skips frames for this time."""


class Pipeline:
    """Tracker, gesture and profile in a row, with rest detection beside them.

    Args:
        rest: finds the frames that show the gel at rest.
        tracker: follows the markers.
        recognizer: recognises the gesture from the markers.
        mapping: turns the gesture into a pad state.
        frame_thread: frames are processed beside the pipeline, so no pad state waits for them.

    Attributes:
        timings: the host time of each stage.
    """

    def __init__(
        self,
        rest: FrameExchange,
        tracker: MarkerTracker,
        recognizer: GestureRecognizer,
        mapping: Mapping,
        *,
        frame_thread: bool = False,
    ) -> None:
        self.rest = rest
        self.tracker = tracker
        self.recognizer = recognizer
        self.mapping = mapping
        self.has_frame_thread = frame_thread
        self.timings = StageTimings()
        self._partial: EventPacket | None = None
        self._anchor: RestField | None = None
        self._flicker: Flicker | None = None
        self._has_events: bool | None = None  # not told yet
        self._idle_us = self._looked_us = 0

    @classmethod
    def build(
        cls,
        profile: Profile,
        gesture: GestureConfig,
        *,
        user: UserSettings | None = None,
        rig: Rig | None = None,
        near_rad: float = 0.0,
        frame_thread: bool = False,
        gel: Gel = PAPER_GEL,
    ) -> "Pipeline":
        """Builds the pipeline as it is shipped.

        Args:
            profile: the bindings of the gestures.
            gesture: the method that recognises them.
            user: the person's own values with their neutral pose; without, the reference hand.
            rig: known view of the sensor, if there is a rig file.
            near_rad: without, the turn of the lattice in the image that is expected.
            frame_thread: process frames in a thread beside the pipeline. Otherwise the pipeline
                does it itself, so that a recording gives the same Steps bit for bit at any speed.
            gel: the gel before the camera.
        """
        if user is not None:
            gesture = replace(gesture, neutral=user.neutral)
        finder = BlobFinder(gel=gel)
        detector = RestDetector(rig=rig, finder=finder, near_rad=near_rad, gel=gel)
        rest: FrameExchange = (
            ThreadedRest(detector, finder) if frame_thread else InlineRest(detector)
        )
        # The thread's finder is its own; without events the tracker searches frames itself.
        tracker = MarkerTracker(
            finder=None if frame_thread else finder, gel=gel, looks_late=frame_thread
        )
        return cls(
            rest,
            tracker,
            GestureRecognizer(gesture, gel),
            Mapping(profile, user),
            frame_thread=frame_thread,
        )

    def advance_partial(self, packet: EventPacket) -> None:
        """Takes in the first part of the next slice, which leaves less to do then.

        It needs a frame thread.
        """
        begun_ns = perf_counter_ns()
        self.tracker.update(packet)
        self.timings.partial.end(begun_ns)
        self._partial = packet

    def advance(self, packet: EventPacket) -> Step:
        """Takes one slice through all stages.

        With a frame thread, write the pad afterwards, then call ``finish``.
        """
        markers, gesture = self._find_gesture(packet)
        begun_ns = perf_counter_ns()
        pad = self.mapping.update(gesture)
        self.timings.profile.end(begun_ns)
        if "rezero" in pad.commands:
            self.recognizer.rezero()
        return Step(packet, self._anchor, markers, gesture, pad, self.gel)

    def recognize(self, packet: EventPacket) -> Step:
        """Takes one slice up to the gesture; the profile has no part, and the pad is neutral."""
        markers, gesture = self._find_gesture(packet)
        pad = GamepadState(gesture.t_us)
        return Step(packet, self._anchor, markers, gesture, pad, self.gel)

    def _find_gesture(self, packet: EventPacket) -> tuple[MarkerField, Gesture]:
        if self.has_frame_thread:
            packet_left = self._cut_remaining(packet)
        else:
            self._anchor = self._exchange(packet)
            packet_left = packet
        timings, begun_ns = self.timings, perf_counter_ns()
        markers = self.tracker.update(packet_left)
        begun_ns = timings.tracker.end(begun_ns)
        if self._anchor is not None:
            self.recognizer.note_rest(self._anchor.t_us)
        if self.tracker.is_frameless:
            self._do_without_frames(packet.t_end_us)
        if self.tracker.flicker is not self._flicker:
            self._flicker = self.tracker.flicker
            self.rest.detector.note_flicker(self._flicker.hz if self._flicker else None)
        if self.tracker.has_events is not self._has_events:
            self._has_events = self.tracker.has_events
            self.rest.detector.note_camera(has_events=self._has_events)
        gesture = self.recognizer.update(markers)
        timings.gesture.end(begun_ns)
        if self.tracker.is_unsure:
            self.rest.detector.note_haste(packet.t_end_us)
            gesture = no_gesture(gesture.t_us)
        return markers, gesture

    @property
    def gel(self) -> GelState:
        """The gel as the frames show it; a hand that may rest on it is no problem."""
        gel = self.rest.detector.gel
        if gel.problem is GelProblem.RESTS and self.recognizer.neutral == "resting":
            return replace(gel, problem=GelProblem.NONE)
        return gel

    @property
    def is_idle(self) -> bool:
        """True if the hand has done nothing for a while; it needs a frame thread."""
        return self._idle_us >= IDLE_US

    @property
    def is_at_rest(self) -> bool:
        """True if it is idle, and the newest frame that was processed showed the gel at rest.

        Never in light that flickers: what is left of its events moves the markers until the next
        frame brings them back. Never without events: only the next frame shows that a hand moves.
        """
        if not self.is_idle or self.tracker.flicker is not None or self.tracker.follows_frames:
            return False
        seen = self.rest.detector.stats()
        return seen.n_rest > 0 and not seen.problem

    def finish(self, step: Step) -> None:
        """Takes in frames, and looks for hot pixels and flicker, after the pad was written.

        Frames move markers by tenths of a pixel, and it is known where these were when the frame
        was exposed. What is looked for now and then would make the slowest slices slower still.
        Without a frame thread nothing is left to do.
        """
        if not self.has_frame_thread:
            return
        packet = step.packet
        if step.gesture.kind is GestureKind.NONE and step.pad.is_neutral:
            self._idle_us += packet.t_end_us - packet.t_begin_us
        else:
            self._idle_us = 0
        if packet.frames and self._may_skip(packet.frames[-1].t_us):
            packet = _without_frames(packet)
        self._anchor = self._exchange(packet)
        self.tracker.look()

    def _cut_remaining(self, packet: EventPacket) -> EventPacket:
        """Returns the part of a slice that has not been taken in yet, without frames.

        If frames alone carry the markers, they stay: the next step would be a frame late.
        """
        partial, self._partial = self._partial, None
        if partial is None or partial.t_begin_us != packet.t_begin_us:
            return packet if self.tracker.follows_frames else _without_frames(packet)
        events, gap = packet.events[len(partial.events) :], packet.gap - partial.gap
        return EventPacket(partial.t_end_us, packet.t_end_us, events, (), gap)

    def _exchange(self, packet: EventPacket) -> RestField | None:
        begun_ns = perf_counter_ns()
        result = self.rest.exchange(packet)  # newest result or None; never blocks
        self.timings.rest.end(begun_ns)
        gel = self.rest.detector.gel
        if gel.was_found and not gel.is_found:
            self.tracker.forget()
            return None
        if result is None:
            return None
        if result.rest is not None:
            self.tracker.anchor(result.rest)
        if result.searched is not None:
            begun_ns = perf_counter_ns()
            self.tracker.correct(*result.searched)
            self.timings.frames.end(begun_ns)
        return result.rest

    def _do_without_frames(self, t_us: int) -> None:
        """Lets events show the gel at rest, where frames are missing.

        A hand that may rest on the gel would be taken for an untouched gel, so it asks for
        ``rezero`` instead.
        """
        self.rest.detector.note_missing_frames(t_us)
        if self.recognizer.neutral == "resting":
            return
        back = self.tracker.find_return()
        if back is not None:
            self.tracker.anchor(back)
            self._anchor = back

    def _may_skip(self, frame_us: int) -> bool:
        """Tells whether a frame brings nothing new: the gel is idle and was at rest just before."""
        if self.is_at_rest and 0 <= frame_us - self._looked_us < IDLE_FRAME_US:
            return True
        self._looked_us = frame_us
        return False

    def close(self) -> None:
        """Ends the thread of the rest detection, if there is one; a second call does nothing."""
        self.rest.close()


def _without_frames(packet: EventPacket) -> EventPacket:
    if not packet.frames:
        return packet
    return EventPacket(packet.t_begin_us, packet.t_end_us, packet.events, (), packet.gap)
