"""Maps gestures to outputs: a pure function of the gesture stream.

Host time never enters, so the same gestures give the same outputs, whatever the speed.
"""

from typing import Final

from neurotouch_hid.messages import Button, GamepadState, Gesture, GestureKind
from neurotouch_hid.profile.decision_log import DecisionLog, MappingDecision
from neurotouch_hid.profile.engine.binding_runner import BindingRunner
from neurotouch_hid.profile.engine.conditioned_gesture import ConditionedGesture
from neurotouch_hid.profile.engine.fatigue import FatigueMonitor
from neurotouch_hid.profile.engine.input_conditioner import InputConditioner
from neurotouch_hid.profile.engine.layer_stack import LayerStack, make_runner
from neurotouch_hid.profile.engine.movement_usage import MovementUsage
from neurotouch_hid.profile.engine.output import Outputs
from neurotouch_hid.profile.schema.profile import Binding, Profile, SafetyGesture
from neurotouch_hid.profile.schema.targets import CommandName, CommandTarget
from neurotouch_hid.profile.schema.timing import PRESETS, resolve_times
from neurotouch_hid.profile.schema.user import UserSettings, choose_filter
from neurotouch_hid.vocabulary import PipelineState

SILENCE_US: Final = 200_000
"""After a gap of this length in the stream everything is released: the hand may have left."""


class Mapping:
    """Carries out a profile for a person.

    Every gesture gives all outputs. Where two bindings move one axis, the larger magnitude wins;
    where they are equal, the earlier binding. A button is down as long as one of its
    bindings holds it. No gesture, or a measurement that is not a number, releases everything
    that is not toggled, sticky or the end of a tap.

    A change of layer or profile, a pause and a gap in the stream release everything; then the
    current gesture must end before another one acts.

    Args:
        profile: what the gestures mean.
        user: the person's own values; the reference hand without.
    """

    def __init__(self, profile: Profile, user: UserSettings | None = None) -> None:
        self._user = user or UserSettings()
        self._log = DecisionLog()
        self._state: PipelineState = "running"
        self._is_for_program = False  # the pause
        self._commands: list[str] = []
        self._t_us: int | None = None
        self._is_calm = False  # the same pad state until the next gesture
        self._helper: frozenset[Button] = frozenset()
        self._reading = ConditionedGesture(0)
        self._fatigue = FatigueMonitor(self._user, self._log)
        self._take(profile)

    @property
    def profile(self) -> Profile:
        """The active profile."""
        return self._profile

    @property
    def layer(self) -> str:
        """The name of the active layer."""
        return self._layers.name

    @property
    def state(self) -> PipelineState:
        """The state: running, paused (the same gesture resumes) or panic."""
        return self._state

    @property
    def is_paused_for_program(self) -> bool:
        """True while it is paused for a program, and not by a person."""
        return self._is_for_program

    @property
    def reading(self) -> ConditionedGesture:
        """The last conditioned gesture, in millimetres of the reference hand."""
        return self._reading

    def decisions(self) -> tuple[MappingDecision, ...]:
        """Returns the latest decisions, oldest first: what was pressed, or ignored and why."""
        return self._log.read()

    def usages(self) -> tuple[MovementUsage, ...]:
        """Returns the usage of each movement so far: which fade, which are held long."""
        return self._fatigue.usages()

    def shares(self) -> dict[str, float]:
        """Returns the share of its full range that each movement needs now, where below 1."""
        return self._fatigue.shares()

    def switch(self, profile: Profile, user: UserSettings | None = None) -> None:
        """Releases everything and goes on with another profile at the next gesture.

        Args:
            profile: the new one, or the same after an edit.
            user: the person's new values; as before without.
        """
        if user is not None:
            self._user = user
            self._fatigue = FatigueMonitor(user, self._log)
        self._take(profile)
        self._layers.armed = False

    def pause(self, *, for_program: bool = False) -> None:
        """Releases everything until ``resume`` or the gesture that pauses.

        Args:
            for_program: until ``resume`` or ``end_program_pause``, whatever the gestures: the
                program asks for movements. A pause that was there before stays as it is.
        """
        if self._state == "running":
            self._enter("paused", "pause")
            self._is_for_program = for_program
        elif not for_program:
            self._is_for_program = False

    def end_program_pause(self) -> None:
        """Resumes if a program has paused, and no person since."""
        if self._is_for_program:
            self.resume()

    def panic(self) -> None:
        """Releases everything until ``resume``."""
        if self._state != "panic":
            self._enter("panic", "panic")

    def resume(self) -> None:
        """Resumes at the next gesture."""
        if self._state != "running":
            self._enter("running", "resume")

    def release(self) -> None:
        """Releases everything; a gesture in progress is ignored, the next one counts."""
        self._conditioner.forget()
        self._layers.release()
        self._is_calm = False

    def set_helper_buttons(self, buttons: frozenset[Button]) -> None:
        """Sets the buttons that are down on the co-pilot's device."""
        if buttons != self._helper:
            self._helper = buttons
            self._is_calm = False

    def update(self, gesture: Gesture) -> GamepadState:
        """Returns all outputs for this gesture, given what came before it."""
        t_us = self._log.t_us = gesture.t_us
        before_us, self._t_us = self._t_us, t_us
        if before_us is not None and not 0 <= t_us - before_us <= SILENCE_US:
            self.release()
        if self._is_calm and gesture.kind is GestureKind.NONE:  # like most steps
            self._reading.t_us = self._conditioner.t_us = t_us
            self._fatigue.pass_time(t_us)
            return GamepadState(t_us)
        reading = self._reading = self._conditioner.read(gesture)
        reading.helper = self._helper
        self._fatigue.update(reading)
        if self._conditioner.at_rest:
            self._layers.armed = True
        outputs = self._run(reading)
        commands, self._commands = tuple(self._commands), []
        self._is_calm = (
            gesture.kind is GestureKind.NONE
            and self._layers.is_calm
            and not any(runner.busy for runner, _ in self._safety)
        )
        return GamepadState(
            t_us,
            frozenset(outputs.buttons),
            outputs.axes,
            frozenset(outputs.keys),
            frozenset(outputs.mouse_buttons),
            outputs.pointer,
            outputs.wheel,
            commands,
        )

    def _run(self, reading: ConditionedGesture) -> Outputs:
        wanted, outputs = self._hear_safety(reading), None
        if self._state == "running" and not wanted:
            outputs = self._layers.run(reading, wanted)
        elif self._state == "paused" and not wanted:
            self._layers.listen(reading, wanted)
        for command in wanted:
            self._apply(command)
        return outputs if outputs is not None and self._state == "running" else Outputs()

    def _hear_safety(self, reading: ConditionedGesture) -> list[str]:
        """Returns the commands of safety gestures that have just been held long enough.

        They work in every state.
        """
        heard = []
        for runner, command in self._safety:
            before = runner.down
            if runner.busy or reading.kind in runner.kinds:
                runner.update(reading)
            if runner.down and not before:
                heard.append(command)
        return heard

    def _apply(self, command: str) -> None:
        match command:
            case "pause" if self._is_for_program:
                pass
            case "pause" if self._state == "paused":
                self.resume()
            case "pause":
                self.pause()
            case "panic":
                self.panic()
            case _ if self._state == "running":
                self._commands.append(command)
                self._log.note("command", command)

    def _enter(self, state: PipelineState, command: str) -> None:
        self._fatigue.rest()
        self._state = state
        self._is_for_program = False
        self._is_calm = False
        self._layers.release()
        self._commands.append(command)
        self._log.note("command", command)

    def _take(self, profile: Profile) -> None:
        self._profile = profile
        self._is_calm = False
        times = resolve_times(profile.timing, self._user.timing)
        self._layers = LayerStack(profile, times, self._log)
        self._safety = self._make_safety(profile)
        kinds = self._layers.kinds.union(*(runner.kinds for runner, _ in self._safety))
        latch = profile.latch is not False
        self._conditioner = InputConditioner(
            self._user, choose_filter(profile, self._user), kinds, latch=latch
        )

    def _make_safety(self, profile: Profile) -> list[tuple[BindingRunner, str]]:
        gestures: tuple[tuple[CommandName, SafetyGesture | None], ...] = (
            ("panic", profile.safety.panic),
            ("pause", profile.safety.pause),
        )
        return [
            (
                make_runner(
                    Binding.model_construct(
                        when=gesture.condition, do=CommandTarget.model_construct(command=name)
                    ),
                    PRESETS["game"],
                    (),
                    self._log,
                ),
                name,
            )
            for name, gesture in gestures
            if gesture is not None
        ]
