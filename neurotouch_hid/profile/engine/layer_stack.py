"""The layers of a profile at work: one of them is active at a time."""

from collections.abc import Iterable
from typing import Final

from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile.decision_log import DecisionLog
from neurotouch_hid.profile.diagnostics.description import describe_binding
from neurotouch_hid.profile.engine.binding_runner import BindingRunner
from neurotouch_hid.profile.engine.conditioned_gesture import ConditionedGesture
from neurotouch_hid.profile.engine.missed_threshold import MissedThreshold
from neurotouch_hid.profile.engine.output import Outputs
from neurotouch_hid.profile.engine.pointer import PointerCare
from neurotouch_hid.profile.schema.layering import merge_bindings
from neurotouch_hid.profile.schema.profile import Binding, Profile
from neurotouch_hid.profile.schema.targets import CommandTarget, LayerTarget, MouseMotionTarget
from neurotouch_hid.profile.schema.timing import Times

_NONE: Final[frozenset[BindingRunner]] = frozenset()

STOPPING: Final = ("pause", "panic")
"""The commands that are heard even while everything is paused."""


class LayerStack:
    """Runs the bindings of the active layer.

    Attributes:
        kinds: every gesture that any binding waits for.
        armed: the current gesture may act; false after a change until it has ended.
    """

    def __init__(self, profile: Profile, times: Times, log: DecisionLog) -> None:
        layers = profile.all_layers
        self._names = [layer.name for layer in layers]
        self._layers = [_Layer(merge_bindings(layer, layers[0]), times, log) for layer in layers]
        self._log = log
        self._current = 0
        self._holder: BindingRunner | None = None
        self._for_one_action = False
        self.armed = True
        self.kinds = frozenset(
            kind for layer in self._layers for runner in layer.runners for kind in runner.kinds
        )

    @property
    def name(self) -> str:
        """The name of the active layer."""
        return self._names[self._current]

    @property
    def is_calm(self) -> bool:
        """True if nothing is down, and the next gesture may act but none is there."""
        layer = self._layers[self._current]
        return self.armed and self._holder is None and not layer.busy and not layer.cares

    def release(self) -> None:
        """Releases everything, back to the first layer."""
        self._enter(0)

    def run(self, reading: ConditionedGesture, commands: list[str]) -> Outputs:
        """Returns the outputs of the bindings; commands they give are added to ``commands``."""
        if self._holder is not None:
            self._holder.update(reading)
            if not self._holder.down:
                return self._go(0)
        if not self.armed:
            reading = ConditionedGesture(reading.t_us)
        layer = self._layers[self._current]
        outputs = Outputs()
        pressed, finished = [], False
        wanted, silent = layer.find_wanted(reading), layer.find_silent(reading)
        for runner in layer.find_concerned(wanted):
            before = runner.down
            if runner in silent:
                runner.withdraw(reading.t_us)
            else:
                runner.update(reading)
                if runner.down != before and not runner.binding.is_followed:
                    if runner.down:
                        pressed.append(runner)
                    elif runner.binding.mode not in ("sticky", "oneshot"):
                        finished = True
            if runner.busy:
                layer.busy.add(runner)
            if runner.down and runner.put is not None:
                runner.put(outputs, reading)
        layer.missed.update(reading, wanted)
        if finished:
            self._finish_action(layer)
        for care in layer.cares:
            care.tend(outputs, reading.t_us)
        for runner in pressed:
            self._log.note("pressed", runner.label)
            if isinstance(runner.binding.do, CommandTarget):
                commands.append(runner.binding.do.command)
            elif isinstance(runner.binding.do, LayerTarget):
                return self._change(runner, runner.binding.do)
        if finished and self._for_one_action:
            return self._go(0)
        return outputs

    def listen(self, reading: ConditionedGesture, commands: list[str]) -> None:
        """Reads only the bindings that pause or panic, while paused."""
        if not self.armed:
            return
        layer = self._layers[self._current]
        layer.busy.update(layer.stopping)
        for runner in layer.stopping:
            before = runner.down
            runner.update(reading)
            if runner.down and not before and isinstance(runner.binding.do, CommandTarget):
                commands.append(runner.binding.do.command)

    def _finish_action(self, layer: "_Layer") -> None:
        for runner in layer.runners:
            runner.finish_action()

    def _change(self, runner: BindingRunner, target: LayerTarget) -> Outputs:
        wanted = self._names.index(target.layer) if target.layer in self._names else 0
        if wanted == self._current:
            return self._go(0)
        outputs = self._go(wanted, runner if target.mode == "hold" else None)
        self._for_one_action = target.mode == "oneshot"
        return outputs

    def _go(self, index: int, holder: BindingRunner | None = None) -> Outputs:
        """Enters a layer: nothing is put out before the next gesture."""
        self._enter(index, holder)
        self._log.note("layer", self.name)
        return Outputs()

    def _enter(self, index: int, holder: BindingRunner | None = None) -> None:
        """Releases everything but the runner that holds the layer to come."""
        for runner in (*self._layers[self._current].runners, self._holder):
            if runner is not None and runner is not holder and runner.busy:
                runner.reset()
        self._current = index
        self._holder = holder
        self._for_one_action = False
        self.armed = False


class _Layer:
    """The runners of one layer, and the care for its pointer.

    Attributes:
        runners: one for each binding, in the order of the profile.
        busy: those that were busy after the last step, and perhaps others.
        stopping: those that pause or panic.
        cares: one for each binding that moves the pointer.
        missed: watches for gestures that end just below a threshold.
    """

    def __init__(self, bindings: tuple[Binding, ...], times: Times, log: DecisionLog) -> None:
        self.runners = [make_runner(binding, times, bindings, log) for binding in bindings]
        self.busy: set[BindingRunner] = set()
        self.stopping = [
            runner
            for runner in self.runners
            if isinstance(runner.binding.do, CommandTarget)
            and runner.binding.do.command in STOPPING
        ]
        self.cares = [
            PointerCare(binding.do, log)
            for binding in bindings
            if isinstance(binding.do, MouseMotionTarget)
        ]
        self.missed = MissedThreshold(log)
        self._log = log
        self._chords = [each for each in self.runners if each.binding.condition.with_button]
        plain = frozenset(self.runners).difference(self._chords, self.stopping)
        self._plain = plain
        self._pressing = frozenset(each for each in plain if not each.binding.is_followed)
        self._taken = GestureKind.NONE
        self._wanted: dict[tuple[object, ...], tuple[BindingRunner, ...]] = {}

    def find_wanted(self, reading: ConditionedGesture) -> tuple[BindingRunner, ...]:
        """Returns the runners this gesture may set off, in the order of the profile.

        Found once for each kind and direction.
        """
        key = (reading.kind, reading.four, reading.eight)
        wanted = self._wanted.get(key)
        if wanted is None:
            wanted = tuple(runner for runner in self.runners if runner.may_act(reading))
            self._wanted[key] = wanted
        return wanted

    def find_concerned(self, wanted: tuple[BindingRunner, ...]) -> Iterable[BindingRunner]:
        """Returns the runners that must be asked, in the order of the profile.

        Beside those that a gesture may set off, these are the busy ones.
        """
        busy, self.busy = self.busy, set()
        if busy.issubset(wanted):
            return wanted
        return [each for each in self.runners if each.busy or each in wanted]

    def find_silent(self, reading: ConditionedGesture) -> frozenset[BindingRunner]:
        """Returns the runners that must not hear this gesture, because it is a chord's.

        A longer chord wins over a shorter one: while its button is held, the gesture is the chord's
        alone. Once the button is released, what follows the gesture goes on, but what is pressed
        waits for the next gesture, or two things released one after the other would press a third.
        What pauses or panics is always heard.
        """
        if not self._chords:
            return _NONE
        if any(chord.takes_over(reading) for chord in self._chords):
            if self._taken != reading.kind:
                self._taken = reading.kind
                for runner in self.runners:
                    if runner in self._pressing and runner.may_act(reading):
                        self._log.note("ignored", runner.label, "it is a chord's")
            return self._plain
        if self._taken != reading.kind:
            self._taken = GestureKind.NONE
        return self._pressing if self._taken != GestureKind.NONE else _NONE


def make_runner(
    binding: Binding, times: Times, siblings: tuple[Binding, ...], log: DecisionLog
) -> BindingRunner:
    """Returns a runner that logs what it ignored, and each step of a sequence."""
    label = describe_binding(binding)
    return BindingRunner(
        binding,
        times,
        siblings,
        lambda why: log.note("ignored", label, why),
        lambda which: log.note("step", label, which),
        label,
    )
