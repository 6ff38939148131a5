"""A running pipeline: takes commands from other threads and reports its state to them."""

import os
import time
from collections import deque
from collections.abc import Callable
from typing import Final

from neurotouch_hid.gel_sentences import report_gel
from neurotouch_hid.messages import Button, Step
from neurotouch_hid.profile import Mapping, Profile, UserSettings
from neurotouch_hid.runtime.command_queue import Command, CommandName, CommandQueue
from neurotouch_hid.runtime.pipeline import Pipeline
from neurotouch_hid.runtime.rates import RateMeter
from neurotouch_hid.runtime.stage_timing import StageTimings
from neurotouch_hid.runtime.stall_guard import STALL_S
from neurotouch_hid.status import Fatigue, PipelineStatus, StageSpread

KEPT_ERRORS: Final = 5


class PipelineControl:
    """Connects the pipeline's thread with all others; neither side waits for the other.

    The pipeline's thread calls ``apply_commands`` before a slice and ``record`` after it. All other
    methods may be called from any thread.

    Args:
        pipeline: the running pipeline.
        user: the person's values at the start.

    Attributes:
        meter: counts the steps.
    """

    def __init__(self, pipeline: Pipeline, user: UserSettings) -> None:
        self._pipeline = pipeline
        self._on_command: Callable[[str], object] = str  # nobody yet
        self._helper: Callable[[], frozenset[Button]] | None = None
        self._queue = CommandQueue()
        self._user = user
        self._errors: deque[tuple[float, str]] = deque(maxlen=KEPT_ERRORS)
        self._begun = time.monotonic()
        self._fatigue: list[Fatigue] = []
        self._long_holds: dict[str, int] = {}
        self._step: Step | None = None
        self.meter = RateMeter(pipeline.timings)

    @property
    def mapping(self) -> Mapping:
        """The mapping of the active profile."""
        return self._pipeline.mapping

    @property
    def user(self) -> UserSettings:
        """The person's values that apply now."""
        return self._user

    @property
    def timings(self) -> StageTimings:
        """The host time of each stage."""
        return self._pipeline.timings

    def on_command(self, call: Callable[[str], object]) -> None:
        """Calls ``call`` with the name of each command that takes effect, from any side.

        It is called in the pipeline's thread and must return at once.
        """
        self._on_command = call

    def set_helper(self, helper: Callable[[], frozenset[Button]]) -> None:
        """Asks ``helper`` before each slice which buttons the co-pilot holds."""
        self._helper = helper

    def apply_commands(self) -> None:
        """Applies all commands that were submitted since the last slice."""
        while (command := self._queue.take()) is not None:
            self._apply(command)
            command.done.set_result(self._pipeline.mapping.state)
        if self._helper is not None:
            self._pipeline.mapping.set_helper_buttons(self._helper())

    def record(self, step: Step) -> None:
        """Records a finished step and the commands that the gel gave in it."""
        self._step = step
        if self.meter.add(step):
            self._look_for_fatigue()
        for command in step.pad.commands:
            self._on_command(command)

    def submit(self, name: CommandName) -> Command:
        """Makes the pipeline pause, resume, toggle or panic before its next slice.

        Raises:
            DriverError: too many commands wait.
        """
        return self._queue.submit(Command(name))

    def switch(self, profile: Profile, user: UserSettings) -> Command:
        """Makes the pipeline release everything and continue with another profile.

        Raises:
            DriverError: too many commands wait.
        """
        return self._queue.submit(Command("switch", profile, user))

    def note_error(self, sentence: str) -> None:
        """Keeps a sentence about an error for ``status``."""
        self._errors.append((time.time(), sentence))

    def forget_errors(self) -> bool:
        """Forgets the errors, because the files are in order; returns whether there were any."""
        had_errors = bool(self._errors)
        self._errors.clear()
        return had_errors

    def status(self) -> PipelineStatus:
        """Returns the state of the pipeline, ready for JSON."""
        mapping, step = self._pipeline.mapping, self._step
        counts, rates = self.meter.counts, self.meter.rates
        valid = step.markers.valid if step is not None else ()
        silent_s = time.monotonic() - self.meter.step_s
        return {
            "pid": os.getpid(),
            "state": mapping.state,
            "profile": mapping.profile.name,
            "layer": mapping.layer,
            "markers_tracked": sum(map(bool, valid)),
            "gel": report_gel(self._pipeline.gel),
            "gesture": step.gesture.kind.label if step is not None else "none",
            "ignored": self._find_ignored(),
            "silent_s": round(silent_s, 3) if silent_s > STALL_S else 0.0,
            "uptime_s": round(time.monotonic() - self._begun, 1),
            "slices": counts.slices,
            "slices_hz": round(rates.slices_hz, 1),
            "events_hz": round(rates.events_hz),
            "events_lost": counts.lost,
            "stage_ms": {name: round(ms, 4) for name, ms in rates.stage_ms},
            "stage_spread_ms": {
                name: StageSpread({"p50": p50, "p99": p99, "p99.9": p999})
                for name, (p50, p99, p999) in self.timings.spread_ms().items()
            },
            "fatigue": self._fatigue,
            "long_holds": self._long_holds,
            "errors": [{"at": round(at, 3), "error": text} for at, text in self._errors.copy()],
        }

    def _find_ignored(self) -> str | None:
        """Returns the sentence about the last gesture that had no effect."""
        decisions = self._pipeline.mapping.decisions()
        return next((str(each) for each in reversed(decisions) if each.is_refusal), None)

    def _apply(self, command: Command) -> None:
        mapping = self._pipeline.mapping
        match command.name:
            case "toggle" if mapping.state == "paused":
                mapping.resume()
            case "pause_for_program":
                mapping.pause(for_program=True)
            case "end_program_pause":
                mapping.end_program_pause()
            case "pause" | "toggle":
                mapping.pause()
            case "panic":
                mapping.panic()
            case "resume":
                mapping.resume()
            case "switch" if command.profile is not None:
                self._switch(mapping, command.profile, command.user or self._user)

    def _switch(self, mapping: Mapping, profile: Profile, user: UserSettings) -> None:
        if user == self._user:
            mapping.switch(profile)
            return
        # Other values of the person: a new mapping, as stopped as the old one was.
        fresh = Mapping(profile, user)
        fresh.switch(profile)
        if mapping.state == "paused":
            fresh.pause(for_program=mapping.is_paused_for_program)
        elif mapping.state == "panic":
            fresh.panic()
        recognizer = self._pipeline.recognizer
        if user.neutral != recognizer.neutral:  # else what it knows of the hand stays
            recognizer.choose_neutral(user.neutral)
        self._user = user
        self._pipeline.mapping = fresh

    def _look_for_fatigue(self) -> None:
        mapping = self._pipeline.mapping
        shares = mapping.shares()
        self._fatigue = [
            {
                "movement": usage.movement,
                "peak_mm": usage.peak_mm,
                "full_mm": usage.full_mm,
                "needs": round(shares.get(usage.movement, 1.0), 2),
            }
            for usage in mapping.usages()
            if usage.full_mm is not None or usage.movement in shares
        ]
        self._long_holds = {
            usage.movement: usage.long_holds for usage in mapping.usages() if usage.long_holds
        }
